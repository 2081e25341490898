// SPDX-License-Identifier: MIT
/// The heat-regularized pseudo-time: against exact solutions, against a dense matrix, and its adjoint against
/// differences (formulation 2.1).
#include "sequence/heat_sequence.h"
#include "support/brute_force.h"
#include "support/heat_case.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

/// T = cosh(m (H - s)) / cosh(m H) at distance s from the plate, m^2 = alpha / kappa: no flux at s = H.
struct Column {
  double height = 1.7, kappa = 0.3, alpha = 0.9;
  double m() const { return std::sqrt(alpha / kappa); }
  double temperature(double s) const { return std::cosh(m() * (height - s)) / std::cosh(m() * height); }
  double slope(double s) const { return -m() * std::sinh(m() * (height - s)) / std::cosh(m() * height); }
};

/// Root mean square errors on a column of `elements` along `plate.axis`.
struct Errors {
  double temperature = 0.0, time = 0.0, gradient = 0.0;
};
template <int Dim>
Errors column_errors(const BuildPlate& plate, int elements, MassRule mass) {
  const Column column;
  Domain<Dim> domain;
  domain.size.fill(0.9);
  domain.elements.fill(2);
  domain.elements[(plate.axis + 1) % Dim] = 3;
  domain.size[plate.axis] = column.height;
  domain.elements[plate.axis] = elements;
  const test::PartOnGrid<Dim> on_grid(
      domain, test::box(std::vector<double>(Dim, 0.0), {domain.size.begin(), domain.size.end()}), plate);
  HeatSettings settings;
  settings.mass = mass;
  settings.drain = 4.0 * column.alpha;
  settings.characteristic_length = 2.0;
  HeatSequence<Dim> sequence = test::heat_sequence<Dim>(on_grid.part, settings);
  const auto& result = sequence.update(std::vector<double>(sequence.variables(), column.kappa));

  const auto distance = [&](const Point<Dim>& x) {
    return plate.upper ? column.height - x[plate.axis] : x[plate.axis];
  };
  std::vector<double> temperature, time, gradient;
  on_grid.grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    const double expected = column.temperature(distance(on_grid.grid.node_position(node)));
    temperature.push_back(result.temperature[offset] - expected);
  });
  for (std::size_t e = 0; e < result.time.size(); ++e) {
    const Index<Dim> element = on_grid.grid.owned_elements().index(on_grid.part.elements()[e]);
    const double s = distance(on_grid.grid.element_center(element));
    time.push_back(result.time[e] - (1.0 - column.temperature(s)));
    for (int a = 0; a < Dim; ++a) {
      const double along = plate.upper ? column.slope(s) : -column.slope(s);
      gradient.push_back(result.gradient[e * Dim + a] - (a == plate.axis ? along : 0.0));
    }
  }
  const auto mean = [&](const std::vector<double>& errors) {
    return std::sqrt(test::dot(errors, errors) / sum(PETSC_COMM_WORLD, static_cast<double>(errors.size())));
  };
  return {mean(temperature), mean(time), mean(gradient)};
}

template <int Dim>
void expect_second_order(const BuildPlate& plate, MassRule mass) {
  Errors coarse = column_errors<Dim>(plate, 4, mass);
  for (const int elements : {8, 16, 32}) {
    const Errors fine = column_errors<Dim>(plate, elements, mass);
    EXPECT_NEAR(std::log2(coarse.temperature / fine.temperature), 2.0, 0.1) << elements;
    EXPECT_NEAR(std::log2(coarse.time / fine.time), 2.0, 0.1) << elements;
    EXPECT_NEAR(std::log2(coarse.gradient / fine.gradient), 2.0, 0.1) << elements;
    coarse = fine;
  }
  EXPECT_LT(coarse.temperature, 2e-4);
}

template <class T>
class HeatSequenceTest : public testing::Test {};
TYPED_TEST_SUITE(HeatSequenceTest, test::Dimensions);

TYPED_TEST(HeatSequenceTest, ConvergesWithSecondOrder) {
  constexpr int Dim = TypeParam::value;
  for (const MassRule mass : {MassRule::consistent, MassRule::lumped}) {
    expect_second_order<Dim>({Dim - 1, false}, mass);
    expect_second_order<Dim>({0, true}, mass);
  }
}

/// Temperature on the whole grid by a dense matrix, with the filter as a double loop would give it (the
/// filter has its own test).
template <int Dim>
std::vector<double> dense_temperature(const Part<Dim>& part, const std::vector<double>& filtered,
                                      const HeatSettings& settings) {
  const Grid<Dim>& grid = part.grid();
  constexpr int corners = corner_count<Dim>;
  const test::BruteForceElement<Dim> element{grid.spacing(), grid.domain().thickness, 0.0};
  const auto conductivity =
      element.template matrix<corners>([&](int i, int j) { return element.conductivity(i, j); });
  const auto mass = element.template matrix<corners>([&](int i, int j) {
    if (settings.mass == MassRule::consistent) return element.mass(i, j);
    return i == j ? grid.element_volume() / corners : 0.0;
  });
  const double alpha = settings.drain / std::pow(*settings.characteristic_length, 2);
  const auto kappa = test::whole_part_field(part, filtered, settings.void_diffusivity);
  const auto inside = test::whole_part_field(part, std::vector<double>(filtered.size(), 1.0));
  test::DenseSystem<Dim> system(grid.domain().elements, 1);
  std::vector<double> plate(system.size(), 0.0);
  grid.all_elements().for_each([&](const Index<Dim>& index, std::int64_t number) {
    system.add(index, conductivity, kappa[number]);
    system.add(index, mass, alpha);
    for (int corner = 0; corner < corners; ++corner)
      if (inside[number] > 0.0 && index[Dim - 1] == 0 && (corner >> (Dim - 1)) == 0) {
        plate[system.unknown(index, corner)] = 1.0;
        system.fix(system.unknown(index, corner));
      }
  });
  std::vector<double> load = system.multiply(plate);
  for (double& value : load) value = -value;
  std::vector<double> temperature = system.solve(load);
  for (std::size_t n = 0; n < temperature.size(); ++n) temperature[n] += plate[n];
  return temperature;
}

TYPED_TEST(HeatSequenceTest, AgreesWithADenseMatrix) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  const Part<Dim>& part = on_grid.part;
  const auto design = test::noise_field(part, 0.02, 1.0);
  for (const MassRule mass : {MassRule::consistent, MassRule::lumped})
    for (const double radius : {0.0, 0.9}) {
      const HeatSettings settings = test::heat_settings(mass, radius);
      HeatSequence<Dim> sequence = test::heat_sequence<Dim>(part, settings);
      const auto& result = sequence.update(design);
      const auto expected =
          dense_temperature(part, AveragingFilter<Dim>(part, radius).apply(design), settings);
      const auto temperature = test::whole_node_field<Dim>(on_grid.grid, result.temperature);
      EXPECT_LT(test::relative_difference(temperature, expected), 1e-10);
      const auto [low, high] = std::minmax_element(expected.begin(), expected.end());
      EXPECT_NEAR(result.lowest_temperature, *low, 1e-10);
      EXPECT_NEAR(result.highest_temperature, *high, 1e-10);
    }
}

TYPED_TEST(HeatSequenceTest, DerivativesAgreeWithDifferences) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  const Part<Dim>& part = on_grid.part;
  const auto design = test::noise_field(part, 0.05, 0.9);
  const auto direction = test::noise_field(part, -1.0, 1.0, 5);
  const std::vector<TimeDerivatives> rows = test::time_functionals(part, 3);
  const auto value = [](const TimeDerivatives& row, const PseudoTime<Dim>& time) {
    return test::dot(row.time, time.time) +
           (row.gradient.empty() ? 0.0 : test::dot(row.gradient, time.gradient));
  };
  for (const double radius : {0.0, 0.9}) {
    auto sequence = test::heat_sequence<Dim>(part, test::heat_settings(MassRule::consistent, radius));
    (void)sequence.update(design);
    const auto gradients = sequence.pull_back(rows);
    EXPECT_EQ(sequence.adjoint_iterations().size(), rows.size());
    for (int row = 0; row < 3; ++row) {
      const double expected = test::central_difference(
          [&](double step) {
            return value(rows[row], sequence.update(test::moved(design, step, direction)));
          },
          2e-3);
      EXPECT_NEAR(test::dot(gradients[row], direction), expected, 1e-7 * std::abs(expected))
          << row << ' ' << radius;
    }
  }
}

TYPED_TEST(HeatSequenceTest, SpaceFollowsTheSettings) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  HeatSettings settings = test::heat_settings(MassRule::automatic);
  for (const VariableScale scale : {VariableScale::log, VariableScale::linear}) {
    settings.scale = scale;
    const DesignScale space = test::heat_sequence<Dim>(on_grid.part, settings).space().of(0);
    EXPECT_EQ(space.lower, 0.02);
    EXPECT_EQ(space.upper, 1.0);
    EXPECT_EQ(space.logarithmic, scale == VariableScale::log);
  }
}

/// Automatic: lumped where alpha max(h)^2 / 6 exceeds the least diffusivity; then the temperature of
/// near-cubic elements stays in [0, 1] however small kappa is.
TYPED_TEST(HeatSequenceTest, MassRuleKeepsTheMaximumPrinciple) {
  constexpr int Dim = TypeParam::value;
  Domain<Dim> cubes;
  cubes.size.fill(1.0);
  cubes.elements.fill(5);
  const test::PartOnGrid<Dim> on_grid(
      cubes, test::box(std::vector<double>(Dim, 0.0), std::vector<double>(Dim, 1.0)));
  const auto rough =
      test::part_field(on_grid.part, [](std::int64_t n) { return test::noise(n) < 0.5 ? 1e-6 : 1.0; });
  const auto temperature = [&](MassRule mass, double drain, double void_diffusivity = 1e-3) {
    HeatSettings settings;
    settings.mass = mass;
    settings.drain = drain;
    settings.min_diffusivity = 1e-6;
    settings.void_diffusivity = void_diffusivity;
    HeatSequence<Dim> sequence = test::heat_sequence<Dim>(on_grid.part, settings);
    return test::whole_node_field<Dim>(on_grid.grid, sequence.update(rough).temperature);
  };
  const auto uses = [&](MassRule mass, double drain, double void_diffusivity = 1e-3) {
    const auto automatic = temperature(MassRule::automatic, drain, void_diffusivity);
    return test::relative_difference(automatic, temperature(mass, drain)) < 1e-9;
  };
  // h = 0.2, l_c = 1: alpha h^2 / 6 = 1e-6 at a drain of 1.5e-4.
  EXPECT_TRUE(uses(MassRule::lumped, 1.51e-4));
  EXPECT_FALSE(uses(MassRule::consistent, 1.51e-4));
  EXPECT_TRUE(uses(MassRule::consistent, 1.49e-4));
  EXPECT_FALSE(uses(MassRule::lumped, 1.49e-4));
  EXPECT_TRUE(uses(MassRule::lumped, 1.49e-4, 0.9e-6));

  const auto lumped = temperature(MassRule::automatic, 1.0);
  EXPECT_GE(*std::min_element(lumped.begin(), lumped.end()), 0.0);
  EXPECT_LE(*std::max_element(lumped.begin(), lumped.end()), 1.0 + 1e-12);
  const auto consistent = temperature(MassRule::consistent, 1.0);
  EXPECT_LT(*std::min_element(consistent.begin(), consistent.end()), -1e-3);
}

/// kappa = alpha (T^2 - T_end^2) / (2 g^2) along a column gives |grad T| = g but for the discretization.
TYPED_TEST(HeatSequenceTest, StartHasAnEvenGradient) {
  constexpr int Dim = TypeParam::value;
  Domain<Dim> domain;
  domain.size.fill(0.4);
  domain.elements.fill(2);
  domain.size[Dim - 1] = 2.0;
  domain.elements[Dim - 1] = 40;
  const test::PartOnGrid<Dim> on_grid(
      domain, test::box(std::vector<double>(Dim, 0.0), {domain.size.begin(), domain.size.end()}));
  HeatSettings settings;
  const double target = 0.45;  // 1 - 0.45 * 2 = 0.1 at the far end
  settings.characteristic_length = 1.0 / target;
  settings.min_diffusivity = 1e-5;
  HeatSequence<Dim> sequence = test::heat_sequence<Dim>(on_grid.part, settings, target);
  const auto design = sequence.initial_design();
  const double alpha = settings.drain * target * target;
  for (std::size_t e = 0; e < design.size(); ++e) {
    const Index<Dim> element = on_grid.grid.owned_elements().index(on_grid.part.elements()[e]);
    const double s = on_grid.grid.element_center(element)[Dim - 1];
    const double end = 1.0 - target * 1.975;
    EXPECT_NEAR(design[e],
                std::max(1e-5, alpha / (2 * target * target) * (std::pow(1 - target * s, 2) - end * end)),
                1e-12);
  }
  const auto& result = sequence.update(design);
  for (std::size_t e = 0; e < design.size(); ++e) {
    const Index<Dim> element = on_grid.grid.owned_elements().index(on_grid.part.elements()[e]);
    // At the very end kappa is cut off at its bound.
    if (element[Dim - 1] >= 36) continue;
    EXPECT_NEAR(result.gradient[e * Dim + Dim - 1], target, 0.05 * target);
  }
  settings.initial = 0.1;
  const auto uniform = test::heat_sequence<Dim>(on_grid.part, settings, target).initial_design();
  EXPECT_EQ(uniform, std::vector<double>(design.size(), 0.1));
}

}  // namespace
}  // namespace fabseq
