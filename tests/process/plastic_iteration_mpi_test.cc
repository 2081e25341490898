// SPDX-License-Identifier: MIT
/// Sweeps of layers that fall apart into pieces, which hang in what is not built yet: the few of an iteration
/// of an optimization against those that leave next to nothing.
#include "fabseq/process/plastic_process.h"
#include "process/plastic_iteration.h"
#include "support/layered_case.h"
#include "support/process_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

namespace fabseq {
namespace {

constexpr int layers_that_hang = 16;

test::LayeredSettings<3> falling_apart() {
  return {.domain = test::v_domain<3>({17, 7, 16}),
          .shape = test::v_shape<3>(),
          .layers = layers_that_hang,
          .beta = 200.0,
          .wave = 0.3};
}

MaterialSettings mild_steel() {
  MaterialSettings result{1.0, 0.3, test::isotropic_strain<3>(-0.01)};
  result.yield_stress = 0.0019;
  result.hardening = 0.0017;
  return result;
}

/// A V-shape in wavy layers.
struct HangingCase {
  HangingCase() {
    const auto time = test::part_field(layered.on_grid.part,
                                       [&](std::int64_t number) { return layered.wavy_time(number); });
    CurvedLayers(layered.on_grid.part.part_density(), uniform_time_points(layers_that_hang),
                 falling_apart().beta, false)
        .set_densities(time, layers);
  }

  /// Displacement, and derivatives of half its square with respect to the densities of each stage.
  struct Found {
    std::vector<double> displacement;
    std::vector<std::vector<double>> derivatives;
  };
  /// `change`: with which sweeps end.
  Found found(double change) const {
    const Grid<3>& grid = layered.on_grid.grid;
    PlasticProcess process(model,
                           std::make_unique<LaneElasticity<3>>(
                               grid, model.domain, material.poisson, LaneCycle{}, 200,
                               AssembledSolverSettings{ReferenceMethod::direct, 1e-9, 1000, "test_"}),
                           groups, BlockSolver::lanes);
    process.set_tolerance({.flow = change});
    const ProcessResult& result = process.simulate({layers, strain, steps_of_layers(layers_that_hang)});
    ProcessAdjoint functional;
    functional.displacement = result.displacement;
    DensityDerivatives derivatives(layers_that_hang);
    const ProcessDerivatives to{.densities = &derivatives};
    process.pull_back(layers, {&functional, 1}, {&to, 1});
    return {test::whole_node_field<3>(grid, result.displacement, 3), derivatives.stage};
  }

  MaterialSettings material = mild_steel();
  test::LayeredCase<3> layered{falling_apart()};
  Supports<3> supports{layered.on_grid.part, layered.on_grid.description};
  ElasticModel<3> model{layered.on_grid.part, supports, material,
                        ProcessSettings{.deposition = DepositionModel::nominal}};
  InherentStrain<3> strain{material, 1.0};
  LayerGroups groups{PETSC_COMM_WORLD, 1};
  LayerDensities layers;
};

/// Of this rank's parts of two fields.
double error_of(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return std::sqrt(sum(PETSC_COMM_WORLD, difference) / sum(PETSC_COMM_WORLD, size));
}

/// One step of the multigrid for each correction would leave errors of 1 in the first nine layers.
TEST(PlasticIterationTest, FewSweepsMovePiecesThatHang) {
  const HangingCase hanging_case;
  const HangingCase::Found exact = hanging_case.found(1e-6), few = hanging_case.found(0.1),
                           more = hanging_case.found(1e-3);
  EXPECT_LT(error_of(few.displacement, exact.displacement), 0.3);
  for (int layer = 0; layer < 9; ++layer)
    EXPECT_LT(error_of(few.derivatives[layer], exact.derivatives[layer]), 0.75) << layer;
  // Solved to 0.01, the adjoints of pieces would leave 0.4 below them.
  for (int layer = 0; layer < 8; ++layer)
    EXPECT_LT(error_of(more.derivatives[layer], exact.derivatives[layer]), 0.15) << layer;
}

}  // namespace
}  // namespace fabseq
