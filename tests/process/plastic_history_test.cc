// SPDX-License-Identifier: MIT
/// The history of plastic flow in an element against closed forms (formulation 16).
#include "process/plastic_history.h"

#include "process/element_modes.h"
#include "support/process_case.h"
#include "support/table_strain.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

constexpr double young = 200.0, yield_stress = 0.4, hardening = 10.0, shrinkage = 0.01;

test::CaseSettings<3> bar() {
  test::CaseSettings<3> settings;
  settings.material.young = young;
  settings.material.poisson = 0.0;
  settings.material.yield_stress = yield_stress;
  settings.material.hardening = hardening;
  settings.material.inherent_strain = {-shrinkage, 0.0, 0.0, 0.0, 0.0, 0.0};
  return settings;
}

/// An element that cannot shorten along x: its stress is sigma_0 + H p, where p makes up for what the
/// shrinkage is beyond the elastic strain, and it gets as much wider.
TEST(PlasticHistoryTest, ABarThatIsHeldFollowsTheClosedForm) {
  const test::ProcessCase<3> process(bar());
  ASSERT_GT(process.model.elements.size(), 0u);
  const double plastic = (young * shrinkage - yield_stress) / (young + hardening);
  const double stress = yield_stress + hardening * plastic;
  LayerDensities densities;
  densities.stage.assign(1, std::vector<double>(process.part().elements().size(), 1.0));
  densities.layer = densities.stage;
  const std::vector<BuildStep> steps = steps_of_layers(1);
  std::vector<double> displacements(ElementModes::components, 0.0);
  displacements[1] = displacements[2] = -0.5 * plastic;
  const PlasticHistory history(process.model);
  PlasticHistory::Output output;
  history.run({densities, steps, nullptr, process.strain}, {0, displacements, false, {}}, output);
  EXPECT_NEAR(output.built.stress[0] * young, stress, 1e-12);
  EXPECT_NEAR(output.built.plastic_strain[0], plastic, 1e-14);
  for (int c = 1; c < voigt_size<3>; ++c) EXPECT_NEAR(output.built.stress[c], 0.0, 1e-14);
  EXPECT_NEAR(output.forces[0] * young, stress, 1e-12);
  EXPECT_EQ(output.released.stress, output.built.stress);
}

/// Where it is let go afterwards, it is stressed no more, and keeps its plastic strain.
TEST(PlasticHistoryTest, ABarThatIsLetGoKeepsItsPlasticStrain) {
  const test::ProcessCase<3> process(bar());
  const double plastic = (young * shrinkage - yield_stress) / (young + hardening);
  LayerDensities densities;
  densities.stage.assign(1, std::vector<double>(process.part().elements().size(), 1.0));
  densities.layer = densities.stage;
  std::vector<double> displacements(ElementModes::components, 0.0), release = displacements;
  displacements[1] = displacements[2] = -0.5 * plastic;
  release[0] = -(yield_stress + hardening * plastic) / young;
  const PlasticHistory history(process.model);
  PlasticHistory::Output output;
  history.run({densities, steps_of_layers(1), nullptr, process.strain}, {0, displacements, false, release},
              output);
  for (int c = 0; c < voigt_size<3>; ++c) EXPECT_NEAR(output.released.stress[c], 0.0, 1e-14);
  EXPECT_EQ(output.released.plastic_strain, output.built.plastic_strain);
}

/// Cold material that is heated keeps its elastic strain: its stress falls with the modulus.
TEST(PlasticHistoryTest, StressFollowsTheModulus) {
  test::CaseSettings<3> settings = bar();
  settings.material.yield_stress = 1e6;
  settings.material.temperatures = {20.0, 1000.0};
  settings.material.young_factors = {1.0, 0.1};
  settings.material.elongations = {0.0, 0.01};
  settings.material.cut_off = 1000.0;
  const test::ProcessCase<3> process(settings);
  LayerDensities densities;
  densities.stage.assign(1, std::vector<double>(process.part().elements().size(), 1.0));
  densities.layer = densities.stage;
  const std::size_t elements = process.model.elements.size();
  const StepTemperatures temperatures{
      {std::vector<double>(elements, 20.0), std::vector<double>(elements, 1000.0)}, 20.0};
  const std::vector<BuildStep> steps = {{0, true}, {0, false}};
  const std::vector<double> displacements(2 * ElementModes::components, 0.0);
  const PlasticHistory history(process.model);
  PlasticHistory::Output output;
  history.run({densities, steps, &temperatures, process.strain}, {0, displacements, true, {}}, output);
  // New material shrinks by 0.01 on its way to 20 degrees, and grows as much on its way back.
  EXPECT_NEAR(output.forces[0], 0.01, 1e-14);
  EXPECT_NEAR(output.forces[ElementModes::components], 0.1 * 0.01 - 0.1 * 0.01, 1e-14);
}

}  // namespace
}  // namespace fabseq
