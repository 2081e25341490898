// SPDX-License-Identifier: MIT
/// What is built when a block of layers comes, by brute force, and the systems of that only, by dense
/// matrices (formulation 4.8).
#include "fabseq/base/mpi.h"
#include "fabseq/process/built_region.h"
#include "fabseq/process/elastic_process.h"
#include "fabseq/solve/solvers.h"
#include "support/process_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace fabseq {
namespace {

constexpr int layer_count = 24;
constexpr double sharpness = 4.0 * layer_count;

template <int Dim>
test::CaseSettings<Dim> nominal() {
  test::CaseSettings<Dim> settings;
  settings.process.deposition = DepositionModel::nominal;
  return settings;
}

/// 1 where an element of the grid is in the region, by the definition.
template <int Dim>
std::vector<double> expected_region(const test::ProcessCase<Dim>& process, const LayerDensities& layers,
                                    int last_layer) {
  const IndexBox<Dim> all = process.grid().all_elements();
  const std::vector<double> stage = test::whole_part_field(process.part(), layers.stage[last_layer], -1.0);
  const double least = process.settings.process.min_stiffness;
  std::vector<double> result(stage.size(), 0.0);
  all.for_each([&](const Index<Dim>& element, std::int64_t number) {
    if (stage[number] < 0.0) return;
    all.for_each([&](const Index<Dim>& other, std::int64_t neighbor) {
      int distance = 0;
      for (int axis = 0; axis < Dim; ++axis)
        distance = std::max(distance, std::abs(other[axis] - element[axis]));
      if (distance <= 1 && stage[neighbor] > 0.0 && std::pow(stage[neighbor], 3.0) > least)
        result[number] = 1.0;
    });
  });
  return result;
}

/// The same of what BuiltRegion finds.
template <int Dim>
std::vector<double> found_region(const test::ProcessCase<Dim>& process, const BlockRegion& region) {
  std::vector<double> of_part;
  for (const int position : process.model.part_position) of_part.push_back(region.has(position) ? 1.0 : 0.0);
  return test::whole_part_field(process.part(), of_part, 0.0);
}

template <int Dim>
BlockRegion region_of(const BuiltRegion<Dim>& built, const LayerDensities& layers, const StepBlock& block) {
  const std::vector<BuildStep> steps = steps_of_layers(layers.count());
  return built.of(layers, block, std::span(steps).subspan(block.first, block.lanes));
}

template <class T>
class BuiltRegionTest : public testing::Test {};
TYPED_TEST_SUITE(BuiltRegionTest, test::Dimensions);

TYPED_TEST(BuiltRegionTest, IsWhatStandsAndItsNeighbors) {
  constexpr int Dim = TypeParam::value;
  const test::ProcessCase<Dim> process(nominal<Dim>());
  const LayerDensities layers = process.densities(process.planar_time(), layer_count, sharpness);
  const BuiltRegion<Dim> built(process.model);
  for (const StepBlock block : {StepBlock{0, 8}, StepBlock{4, 2}, StepBlock{8, 8}, StepBlock{17, 1}}) {
    const std::vector<double> expected = expected_region(process, layers, block.first / 8 * 8 + 7);
    EXPECT_EQ(found_region(process, region_of(built, layers, block)), expected) << block.first;
  }
  const std::vector<double> shares = built.standing_shares(layers);
  EXPECT_LT(shares[7], 0.6);
  EXPECT_EQ(shares[0], shares[7]);
  EXPECT_LT(shares[7], shares[8]);
  EXPECT_GT(shares[23], 0.9);
}

/// Nothing would hold what begins in the air.
TYPED_TEST(BuiltRegionTest, IsEverythingWhereAPieceHasNoHold) {
  constexpr int Dim = TypeParam::value;
  const test::ProcessCase<Dim> process(nominal<Dim>());
  std::vector<double> time = process.planar_time();
  for (double& value : time) value = value < 0.2 || value > 0.8 ? 0.05 : 0.9;
  const LayerDensities layers = process.densities(time, layer_count, sharpness);
  EXPECT_TRUE(region_of(BuiltRegion<Dim>(process.model), layers, {0, 8}).elements.empty());
}

TYPED_TEST(BuiltRegionTest, IncrementsAgreeWithDenseMatrices) {
  constexpr int Dim = TypeParam::value;
  test::ProcessCase<Dim> process(nominal<Dim>());
  const LayerDensities layers = process.densities(process.planar_time(), layer_count, sharpness);
  const auto& grid = process.grid();
  const auto element = process.brute_force_element();
  const auto matrix = element.template matrix<element_unknowns<Dim>>(
      [&](int row, int column) { return element.stiffness(row, column); });
  for (const SolverPath path : {SolverPath::lanes, SolverPath::reference}) {
    SolverSettings settings;
    settings.path = path;
    settings.region = SolverRegion::built;
    ElasticProcess<Dim> simulation(
        process.model,
        make_elasticity_solver(settings, grid, process.model.domain, process.model.element,
                               process.model.material.poisson, 1e-11, widest_block),
        process.groups, BlockSolver::lanes);
    simulation.systems().leave_out_unbuilt(true);
    simulation.simulate(layers, process.strain);
    // Increments are kept on the nodes of the region: the first block's are fewer.
    const auto count = [&](const auto& nodes) {
      return sum(grid.comm(), static_cast<std::int64_t>(nodes.size()));
    };
    EXPECT_LT(count(simulation.result().nodes[0]), count(process.model.nodes));
    for (const int j : {2, 7, 12}) {
      const std::vector<double> region = expected_region(process, layers, j / 8 * 8 + 7);
      auto [stiffness, loads] = process.element_factors(layers, j);
      test::DenseSystem<Dim> system(grid.domain().elements, Dim);
      std::vector<double> load(system.size(), 0.0), touched(system.size() / Dim, 0.0);
      const auto strain = test::strain_tensor<Dim>(process.settings.material.inherent_strain);
      grid.all_elements().for_each([&](const Index<Dim>& index, std::int64_t e) {
        system.add(index, matrix, region[e] * stiffness[e]);
        for (int i = 0; i < element_unknowns<Dim>; ++i) {
          load[system.unknown(index, i)] += region[e] * loads[e] * element.strain_load(i, strain);
          touched[system.unknown(index, i) / Dim] += region[e];
        }
      });
      system.nodes().for_each([&](const Index<Dim>& node, std::int64_t number) {
        for (int c = 0; c < Dim; ++c)
          if (process.is_held(node) || touched[number] == 0.0) system.fix(number * Dim + c);
      });
      const auto expected = system.solve(load);
      EXPECT_GT(test::largest(expected), 0.0);
      EXPECT_LT(test::relative_difference(process.whole(simulation.layer_increment(j)), expected), 1e-6) << j;
    }
  }
}

}  // namespace
}  // namespace fabseq
