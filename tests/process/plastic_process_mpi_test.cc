// SPDX-License-Identifier: MIT
/// The process with plastic flow: that of an elastic one below the yield stress, with bounded stresses beyond
/// it (formulation 16).
#include "fabseq/process/residual_stress.h"
#include "support/flow_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fabseq {
namespace {

constexpr int layer_count = 5;

test::CaseSettings<3> nominal(double yield_stress) {
  test::CaseSettings<3> settings;
  settings.process.deposition = DepositionModel::nominal;
  settings.material.yield_stress = yield_stress;
  settings.material.hardening = 0.05;
  return settings;
}

constexpr double tolerance = 1e-9;

TEST(PlasticProcessTest, IsElasticBelowTheYieldStress) {
  test::ProcessCase<3> process(nominal(1e6));
  const LayerDensities layers = process.densities(process.wavy_time(), layer_count, 10.0);
  process.simulation.release_with({test::exact_solver});
  const ProcessResult& expected = process.simulate(layers);
  const auto flowing = test::plastic_process(process, tolerance, /*released=*/true);
  const ProcessResult& found = flowing->simulate({layers, process.strain, steps_of_layers(layer_count)});
  EXPECT_LT(test::relative_difference(found.displacement, expected.displacement), 1e-8);
  EXPECT_LT(test::relative_difference(found.release, expected.release), 1e-7);
  EXPECT_LT(test::relative_difference(flowing->layer_increment(2), process.simulation.layer_increment(2)),
            1e-8);
  EXPECT_LT(test::relative_difference(flowing->locked_in(layers).stress,
                                      process.simulation.locked_in(layers).stress),
            1e-7);
  EXPECT_LT(test::relative_difference(
                flowing->released({}, found.release).stress,
                process.simulation.released(process.simulation.locked_in(layers), expected.release).stress),
            1e-6);
  EXPECT_EQ(test::largest(flowing->locked_in(layers).plastic_strain), 0.0);
}

/// Beyond the yield stress stresses are bounded, and the release changes them.
TEST(PlasticProcessTest, FlowBoundsTheStress) {
  constexpr double yield_stress = 0.004;
  test::ProcessCase<3> process(nominal(yield_stress));
  const LayerDensities layers = process.densities(process.wavy_time(), layer_count, 40.0);
  const auto flowing = test::plastic_process(process, tolerance, /*released=*/true);
  const ProcessResult& found = flowing->simulate({layers, process.strain, steps_of_layers(layer_count)});
  const LockedIn built = flowing->locked_in(layers), released = flowing->released(built, found.release);
  const auto stress = equivalent_stress(process.part(), built.stress);
  double flows = 0.0;
  for (std::size_t e = 0; e < stress.size(); ++e) {
    const double strain = built.plastic_strain[process.part().elements()[e]];
    EXPECT_LE(stress[e], (yield_stress + 0.05 * strain) * (1.0 + 1e-9));
    flows += strain > 0.0 ? 1.0 : 0.0;
  }
  EXPECT_GT(sum(PETSC_COMM_WORLD, flows), 0.0);
  EXPECT_GT(test::relative_difference(built.stress, released.stress), 1e-3);
  for (std::size_t e = 0; e < built.plastic_strain.size(); ++e)
    EXPECT_GE(released.plastic_strain[e], built.plastic_strain[e]);
}

/// Nothing of a simulation is left for the next.
TEST(PlasticProcessTest, IsTheSameOnceMore) {
  test::ProcessCase<3> process(nominal(0.004));
  const LayerDensities layers = process.densities(process.wavy_time(), layer_count, 40.0);
  const auto flowing = test::plastic_process(process, tolerance, /*released=*/true);
  const ProcessInput<3> input{layers, process.strain, steps_of_layers(layer_count)};
  const std::vector<double> displacement = flowing->simulate(input).displacement;
  // A direct solver on several ranks need not add up in the same order.
  EXPECT_LT(test::relative_difference(flowing->simulate(input).displacement, displacement), 1e-9);
}

}  // namespace
}  // namespace fabseq
