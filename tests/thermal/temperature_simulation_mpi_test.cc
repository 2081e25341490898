// SPDX-License-Identifier: MIT
#include "fabseq/chain/part_temperature.h"
#include "fabseq/thermal/temperature_simulation.h"
#include "support/pipeline_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

namespace fabseq {
namespace {

constexpr const char* warm =
    R"({"heat_input": 2.5e6, "vanishing": 1400, "film_coefficient": 5e-5, "ambient": 15,
  "plate": 60, "passes": 3, "steps": [2, 2]})";

/// The gallows, in a length unit that makes diffusion cross a few elements a step.
inline Settings with_heat(const std::string& thermal) {
  return {{"material.mass_density", "7.85"}, {"process.deposition_rate", "2.5"}, {"process.dwell", "40"},
          {"material.conductivity", "30"},   {"material.heat_capacity", "600"},  {"thermal", thermal},
          {"thermal.film_coefficient", "50"}};
}
/// Conducts less and stores more as it gets hot, with a peak.
inline const Settings curves = {{"thermal.heat_input", "2e7"},
                                {"material.temperatures", "[20, 300, 700, 735, 770, 900]"},
                                {"material.conductivity_factors", "[1.3, 1.1, 0.7, 0.68, 0.66, 0.6]"},
                                {"material.heat_capacity_factors", "[0.7, 0.95, 1.7, 4, 1.6, 1.05]"}};
inline const Settings no_losses = {{"thermal.film_coefficient", "0"}};
/// The gallows hang on a substrate off the plate.
template <int Dim>
Settings off_the_plate() {
  return {{"substrate", Dim == 2 ? R"({"box": {"min": [0, 0.5], "max": [0.6, 0.9]}})"
                                 : R"({"box": {"min": [0, 0, 0.9], "max": [0.4, 0.6, 1.5]}})"},
          {"part.union", Dim == 2 ? R"([{"box": {"min": [0, 0.9], "max": [3, 1.5]}}])"
                                  : R"([{"box": {"min": [0, 0, 1.5], "max": [2, 0.6, 2.5]}}])"}};
}

template <int Dim>
struct HeatedGallows {
  explicit HeatedGallows(const Settings& settings, const std::string& thermal = warm)
      : config(test::gallows_config<Dim>(test::operator+(with_heat(thermal), settings))),
        setup(PETSC_COMM_WORLD, config),
        temperature(setup, 1e-10) {
    layers = setup.layers->make({}, 9.0, false, {});
    const Grid<Dim>& grid = setup.grid;
    const std::vector<double> time = test::part_field(setup.part, [&](std::int64_t number) {
      const auto place = grid.element_center(grid.all_elements().index(number));
      return 0.85 * place[Dim - 1] / grid.domain().size[Dim - 1] + 0.1 * test::noise(number);
    });
    layers->set_densities(time, densities);
  }
  /// A number of each functional and layer.
  std::vector<double> weights(int functional) const {
    std::vector<double> result;
    for (int j = 0; j < densities.count(); ++j) result.push_back(test::noise(j, 30 + functional) - 0.4);
    return result;
  }
  double value(const LayerDensities& of, int functional) {
    const std::vector<double> weight = weights(functional);
    const std::vector<double>& interpass = temperature.simulation.simulate(of).interpass;
    double result = std::inner_product(weight.begin(), weight.end(), interpass.begin(), 0.0);
    if (functional != of_ends) return result;
    const LayerTemperatures& temperatures = temperature.simulation.simulate(of);
    const std::vector<double> weight_of_ends = end_weights();
    const std::size_t nodes = weight_of_ends.size() / static_cast<std::size_t>(2 * densities.count());
    double own = 0.0;
    for (int j = 0; j < densities.count(); ++j)
      for (std::size_t i = 0; i < temperatures.nodes.size(); ++i) {
        const double* weights = &weight_of_ends[2 * j * nodes + temperatures.nodes[i]];
        own += weights[0] * temperatures.after_steps[j][welding_steps() - 1][i] +
               weights[nodes] * temperatures.at_end(j)[i];
      }
    return result + sum(setup.grid.comm(), own);
  }
  std::size_t welding_steps() const {
    return static_cast<std::size_t>(temperature.thermal.properties.welding_steps);
  }
  /// Weights of the excesses at both ends of all layers, which one functional has as well.
  std::vector<double> end_weights() const {
    std::vector<double> result(2 * static_cast<std::size_t>(densities.count()) *
                               setup.grid.owned_nodes().count());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = 1e-2 * test::noise(static_cast<int>(i), 60);
    return result;
  }
  static constexpr int of_ends = 2;
  double total(const std::vector<double>& field) const {
    return sum(setup.grid.comm(), std::accumulate(field.begin(), field.end(), 0.0));
  }

  Config config;
  Setup<Dim> setup;
  PartTemperature<Dim> temperature;
  std::unique_ptr<Layers> layers;
  LayerDensities densities;
};

template <class T>
class TemperatureSimulationTest : public testing::Test {};
TYPED_TEST_SUITE(TemperatureSimulationTest, test::Dimensions);

/// Without losses, what a layer's heat brings is stored: C' psi(theta') - C psi(theta).
TYPED_TEST(TemperatureSimulationTest, EnergyIsConserved) {
  constexpr int Dim = TypeParam::value;
  for (const Settings& material : {Settings{}, curves}) {
    HeatedGallows<Dim> gallows(test::operator+(test::operator+(off_the_plate<Dim>(), no_losses), material));
    const ThermalModel<Dim>& model = gallows.temperature.thermal;
    const LayerTemperatures& result = gallows.temperature.simulation.simulate(gallows.densities);
    const auto stored = [&](const std::vector<double>& capacity, const std::vector<double>& theta) {
      std::vector<double> energy = picked(capacity, model.nodes);
      for (std::size_t i = 0; i < energy.size(); ++i)
        energy[i] *= model.properties.storage.integral(theta[i]);
      return gallows.total(energy);
    };
    double before = stored(model.first_capacity(), result.start), brought = before;
    EXPECT_GT(before, 0.0);
    for (int j = 0; j < result.count(); ++j) {
      const ThermalLayer layer = model.layer(gallows.densities, j);
      for (std::size_t i = 0; i < result.after_steps[j].size(); ++i) {
        if (i < 2) brought += 0.5 * gallows.total(layer.heat);
        const double now = stored(layer.capacity, result.after_steps[j][i]);
        EXPECT_NEAR(now, brought, (material.empty() ? 1e-11 : 1e-10) * brought)
            << "layer " << j << ", step " << i;
      }
    }
  }
}

/// A material that conducts and stores by the same factors has potentials which are the temperatures of one
/// with constant properties.
TYPED_TEST(TemperatureSimulationTest, PotentialsOfEqualCurvesAreLinear) {
  constexpr int Dim = TypeParam::value;
  Settings equal = test::operator+(curves, no_losses);
  equal.emplace_back("material.conductivity_factors", "[0.7, 0.95, 1.7, 4, 1.6, 1.05]");
  HeatedGallows<Dim> curved(equal);
  const IntegratedCurve& curve = curved.temperature.thermal.properties.conduction;
  const std::string plate = formatted("%.17g", 15.0 + curve.integral(60.0 - 15.0));
  HeatedGallows<Dim> linear(test::operator+(no_losses, {curves[0], {"thermal.plate", plate}}));
  const auto& found = curved.temperature.simulation.simulate(curved.densities);
  const auto& expected = linear.temperature.simulation.simulate(linear.densities);
  double hottest = 0.0;
  for (int j = 0; j < found.count(); ++j)
    for (std::size_t i = 0; i < found.nodes.size(); ++i) {
      EXPECT_NEAR(curve.integral(found.at_end(j)[i]), expected.at_end(j)[i], 1e-7);
      hottest = std::max(hottest, found.at_end(j)[i]);
    }
  EXPECT_GT(max(curved.setup.grid.comm(), hottest), 800.0);
}

/// Steps of hours, of which rounding leaves more than of short ones, end at the plate's temperature.
TYPED_TEST(TemperatureSimulationTest, LongPausesEndAtThePlate) {
  constexpr int Dim = TypeParam::value;
  HeatedGallows<Dim> gallows(test::operator+(test::operator+(curves, no_losses),
                                             {{"process.dwell", "1e7"}, {"thermal.steps", "[1, 8]"}}));
  const LayerTemperatures& result = gallows.temperature.simulation.simulate(gallows.densities);
  for (int j = 1; j < result.count(); ++j) EXPECT_NEAR(result.interpass[j], 60.0, 1e-6);
}

/// Nothing but the plate, the air and the heat of the wire makes a temperature.
TYPED_TEST(TemperatureSimulationTest, StaysAtTheAirsWithoutHeat) {
  constexpr int Dim = TypeParam::value;
  const auto stays = [](const Settings& material, const char* ambient) {
    HeatedGallows<Dim> gallows(test::operator+(
        material, {{"thermal.heat_input", "0"}, {"thermal.plate", ambient}, {"thermal.ambient", ambient}}));
    for (const double value : gallows.temperature.simulation.simulate(gallows.densities).interpass)
      EXPECT_NEAR(value, std::stod(ambient), 1e-12);
  };
  stays({}, "15");
  // Between and below the points of the curves.
  stays(curves, "23.7");
  stays(curves, "-7.3");
}

TYPED_TEST(TemperatureSimulationTest, BothPathsAgree) {
  constexpr int Dim = TypeParam::value;
  HeatedGallows<Dim> lanes(curves), reference(test::operator+(curves, {{"solver.path", "reference"}}));
  const auto& found = lanes.temperature.simulation.simulate(lanes.densities);
  const auto& expected = reference.temperature.simulation.simulate(reference.densities);
  for (int j = 0; j < found.count(); ++j) {
    EXPECT_NEAR(found.interpass[j], expected.interpass[j], 1e-9 * expected.interpass[j]);
    for (std::size_t i = 0; i < found.nodes.size(); ++i)
      EXPECT_NEAR(found.at_end(j)[i], expected.at_end(j)[i], 1e-7);
  }
}

/// By the densities themselves, several functionals in blocks of two lanes: with a film, a plate that is
/// warmer than the air, a substrate, and times of steps that follow the layers' masses.
TYPED_TEST(TemperatureSimulationTest, DerivativesAgreeWithDifferences) {
  constexpr int Dim = TypeParam::value;
  constexpr int functionals = 3;
  for (const Settings& settings : {Settings{{"solver.lanes", "2"}}, test::operator+
                                   (test::on_clamped_substrate<Dim>(), {{"process.dwell", "0"}})}) {
    HeatedGallows<Dim> gallows(settings);
    const LayerDensities& densities = gallows.densities;
    gallows.temperature.simulation.simulate(densities);
    std::vector<std::vector<double>> weights;
    std::vector<DensityDerivatives> derivatives(functionals, DensityDerivatives(densities.count()));
    std::vector<TemperatureAdjoint> adjoints;
    for (int f = 0; f < functionals; ++f) weights.push_back(gallows.weights(f));
    const std::vector<double> ends = gallows.end_weights();
    for (int f = 0; f < functionals; ++f)
      adjoints.push_back({weights[f], f == gallows.of_ends ? std::span(ends) : std::span<const double>(),
                          &derivatives[f], nullptr});
    gallows.temperature.simulation.pull_back(densities, adjoints);
    // In proportion: what does not stand yet must not get less than nothing.
    const auto change = [&](const std::vector<double>& density, int salt) {
      std::vector<double> result = test::part_field(
          gallows.setup.part, [&](std::int64_t number) { return test::noise(number, 40 + salt) - 0.5; });
      for (std::size_t e = 0; e < result.size(); ++e) result[e] *= density[e];
      return result;
    };
    for (int f = 0; f < functionals; ++f) {
      double found = 0.0;
      for (int j = 0; j < densities.count(); ++j) {
        const std::vector<double> of_stage = change(densities.stage[j], 2 * j),
                                  of_layer = change(densities.layer[j], 2 * j + 1);
        for (std::size_t e = 0; e < derivatives[f].stage[j].size(); ++e)
          found += derivatives[f].stage[j][e] * of_stage[e] + derivatives[f].layer[j][e] * of_layer[e];
      }
      found = sum(gallows.setup.grid.comm(), found);
      const auto value = [&](double step) {
        LayerDensities moved = densities;
        for (int j = 0; j < moved.count(); ++j) {
          const std::vector<double> of_stage = change(densities.stage[j], 2 * j),
                                    of_layer = change(densities.layer[j], 2 * j + 1);
          for (std::size_t e = 0; e < of_stage.size(); ++e) {
            moved.stage[j][e] += step * of_stage[e];
            moved.layer[j][e] += step * of_layer[e];
          }
        }
        return gallows.value(moved, f);
      };
      const double expected = test::central_difference(value, 1e-4);
      EXPECT_NEAR(found, expected, 1e-6 * std::abs(expected)) << "functional " << f;
    }
  }
}

/// With the pauses that it asks for, each layer begins at the limit.
TYPED_TEST(TemperatureSimulationTest, PausesKeepTheLimit) {
  constexpr int Dim = TypeParam::value;
  for (const Settings& material : {Settings{}, curves}) {
    HeatedGallows<Dim> gallows(test::operator+(
        material, {{"thermal.passes", "1"}, {"process.dwell", "0"}, {"thermal.plate", "15"}}));
    const double limit =
        15.0 + 0.5 * (gallows.temperature.simulation.simulate(gallows.densities).interpass.back() - 15.0);
    const NeededPauses pauses = gallows.temperature.simulation.needed_pauses(gallows.densities, limit);
    ASSERT_EQ(pauses.seconds.size(), static_cast<std::size_t>(gallows.densities.count()));
    EXPECT_EQ(pauses.seconds.back(), 0.0);
    EXPECT_GT(pauses.seconds[pauses.seconds.size() - 2].value(), 0.0);
    // The longest of them for every layer cools more than enough.
    double longest = 0.0;
    for (const auto& pause : pauses.seconds) longest = std::max(longest, pause.value());
    HeatedGallows<Dim> rested(test::operator+(material, {{"thermal.plate", "15"},
                                                         {"thermal.passes", "1"},
                                                         {"process.dwell", std::to_string(longest)},
                                                         {"thermal.steps", "[2, 100]"}}));
    for (const double value : rested.temperature.simulation.simulate(rested.densities).interpass)
      EXPECT_LT(value, 1.02 * limit);
    EXPECT_NEAR(pauses.welding, 7.85 * gallows.setup.part.volume() / 2.5 * 3600.0, 1e-6 * pauses.welding);
  }
}

TEST(ThermalPropertiesTest, StrainVanishesWhereMaterialSolidifies) {
  MaterialSettings material;
  material.mass_density = 8.0;
  ThermalSettings settings;
  settings.conductivity = 1.0;
  settings.heat_capacity = 2.0;
  settings.vanishing = 1400.0;
  settings.reference = 100.0;
  ProcessSettings process;
  process.deposition_rate = 3.6;
  const ThermalProperties properties(settings, material, process);
  EXPECT_EQ(properties.strain_share(100.0), 1.0);
  EXPECT_EQ(properties.strain_share(750.0), 0.5);
  EXPECT_EQ(properties.strain_share(1500.0), 0.0);
  EXPECT_EQ(properties.strain_share_slope(750.0), -1.0 / 1300.0);
  EXPECT_EQ(properties.strain_share_slope(1500.0), 0.0);
  EXPECT_EQ(properties.rate, 1e-3);
}

TEST(ThermalPropertiesTest, NumbersOfTheBlockHoldAtAllTemperatures) {
  MaterialSettings material;
  material.mass_density = 8.0;
  material.solidification = 1400.0;
  material.conductivity = 1.0;
  material.heat_capacity = 2.0;
  material.temperatures = {0.0, 1000.0};
  material.conductivity_factors = {1.0, 3.0};
  material.heat_capacity_factors = {2.0, 1.0};
  ThermalSettings settings;
  ProcessSettings process;
  process.deposition_rate = 3.6;
  EXPECT_EQ(ThermalProperties(settings, material, process).conduction.value(480.0), 2.0);
  EXPECT_EQ(ThermalProperties(settings, material, process).storage.value(480.0), 1.5);
  settings.conductivity = 5.0;
  EXPECT_TRUE(ThermalProperties(settings, material, process).conduction.is_one());
  EXPECT_FALSE(ThermalProperties(settings, material, process).constant());
  settings.heat_capacity = 5.0;
  EXPECT_TRUE(ThermalProperties(settings, material, process).constant());
}

}  // namespace
}  // namespace fabseq
