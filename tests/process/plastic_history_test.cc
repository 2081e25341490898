// SPDX-License-Identifier: MIT
/// The history of plastic flow in elements against closed forms (formulation 16).
#include "process/plastic_history.h"

#include "support/process_case.h"
#include "support/table_strain.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

constexpr double young = 200.0, yield_stress = 0.4, hardening = 10.0, shrinkage = 0.01;
constexpr int components = ElementModes::components, width = plastic_width;

test::CaseSettings<3> bar() {
  test::CaseSettings<3> settings;
  settings.material.young = young;
  settings.material.poisson = 0.0;
  settings.material.yield_stress = yield_stress;
  settings.material.hardening = hardening;
  settings.material.inherent_strain = {-shrinkage, 0.0, 0.0, 0.0, 0.0, 0.0};
  return settings;
}

/// A full layer, and the history of the first batch of its elements.
struct Bar {
  explicit Bar(const test::CaseSettings<3>& settings, std::vector<BuildStep> steps_ = steps_of_layers(1),
               StepTemperatures temperatures_ = {})
      : process(settings),
        steps(std::move(steps_)),
        temperatures(std::move(temperatures_)),
        batches(process.groups, process.model.elements.size()),
        modes(process.model.element, process.grid().spacing()),
        input{densities, steps, temperatures.elements.empty() ? nullptr : &temperatures, process.strain},
        material(process.model, batches, input),
        history(process.model, modes, material, input.heated()) {
    densities.stage.assign(1, std::vector<double>(process.part().elements().size(), 1.0));
    densities.layer = densities.stage;
    point = material.start().front();
  }
  /// All elements of the batch alike. Returns the forces.
  std::vector<double> run(const PlasticWave& wave, const std::vector<double>& displacement) {
    std::vector<double> of_batch, forces(displacement.size() * width);
    for (const double value : displacement) of_batch.insert(of_batch.end(), width, value);
    material.set_wave(wave);
    history.run(wave, 0, of_batch.data(), forces.data(), point);
    return forces;
  }
  PlasticWave wave() const {
    PlasticWave result;
    result.count = static_cast<int>(steps.size());
    return result;
  }

  test::ProcessCase<3> process;
  LayerDensities densities;
  std::vector<BuildStep> steps;
  StepTemperatures temperatures;
  PlasticBatches batches;
  ElementModes modes;
  PlasticInput input;
  PlasticMaterial material;
  PlasticHistory history;
  PlasticPoint point;
};

/// An element that cannot shorten along x: its stress is sigma_0 + H p, where p makes up for what the
/// shrinkage is beyond the elastic strain, and it gets as much wider.
TEST(PlasticHistoryTest, ABarThatIsHeldFollowsTheClosedForm) {
  Bar bar_(bar());
  const double plastic = (young * shrinkage - yield_stress) / (young + hardening);
  const double stress = yield_stress + hardening * plastic;
  std::vector<double> displacement(components, 0.0);
  displacement[1] = displacement[2] = -0.5 * plastic;
  const std::vector<double> forces = bar_.run(bar_.wave(), displacement);
  EXPECT_NEAR(bar_.point.stress[0][0] * young, stress, 1e-12);
  EXPECT_NEAR(bar_.point.plastic_strain[0], plastic, 1e-14);
  for (int c = 1; c < voigt_size<3>; ++c) EXPECT_NEAR(bar_.point.stress[c][0], 0.0, 1e-14);
  EXPECT_NEAR(forces[0] * young, stress, 1e-12);
}

/// Where it is let go afterwards, it is stressed no more, and keeps its plastic strain.
TEST(PlasticHistoryTest, ABarThatIsLetGoKeepsItsPlasticStrain) {
  Bar bar_(bar());
  const double plastic = (young * shrinkage - yield_stress) / (young + hardening);
  std::vector<double> displacement(components, 0.0), release = displacement;
  displacement[1] = displacement[2] = -0.5 * plastic;
  release[0] = -(yield_stress + hardening * plastic) / young;
  bar_.run(bar_.wave(), displacement);
  const double kept = bar_.point.plastic_strain[0];
  PlasticWave behind;
  behind.first = behind.count = 1;
  behind.release = true;
  bar_.run(behind, release);
  for (int c = 0; c < voigt_size<3>; ++c) EXPECT_NEAR(bar_.point.stress[c][0], 0.0, 1e-14);
  EXPECT_EQ(bar_.point.plastic_strain[0], kept);
}

/// Cold material that is heated keeps its elastic strain: its stress falls with the modulus.
TEST(PlasticHistoryTest, StressFollowsTheModulus) {
  test::CaseSettings<3> settings = bar();
  settings.material.yield_stress = 1e6;
  settings.material.temperatures = {20.0, 1000.0};
  settings.material.young_factors = {1.0, 0.1};
  settings.material.elongations = {0.0, 0.01};
  settings.material.cut_off = 1000.0;
  const std::size_t elements = test::ProcessCase<3>(settings).model.elements.size();
  Bar heated(settings, {{0, true}, {0, false}},
             {{std::vector<double>(elements, 20.0), std::vector<double>(elements, 1000.0)}, 20.0});
  const std::vector<double> forces =
      heated.run(heated.wave(), std::vector<double>(2 * static_cast<std::size_t>(components), 0.0));
  // New material shrinks by 0.01 on its way to 20 degrees, and grows as much on its way back.
  EXPECT_NEAR(forces[0], 0.01, 1e-14);
  EXPECT_NEAR(forces[static_cast<std::size_t>(components) * width], 0.1 * 0.01 - 0.1 * 0.01, 1e-14);
}

}  // namespace
}  // namespace fabseq
