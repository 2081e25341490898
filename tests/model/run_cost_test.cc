// SPDX-License-Identifier: MIT
/// What a run is said to cost: how the figures follow from its size. tests/integration/configs_test.py holds
/// them against a run.
#include "fabseq/model/run_cost.h"

#include "fabseq/layers/layer_model.h"
#include "fabseq/model/placed_part.h"
#include "fabseq/responses/response_type.h"
#include "support/refusal.h"
#include "support/small_configs.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>
#include <petscsys.h>

namespace fabseq {
namespace {

/// A million nodes, half of them the part's.
RunSize large() {
  return {.unknowns = 1.5e6,
          .nodes = 1e6,
          .part_elements = 4.5e5,
          .dimension = 3,
          .layers = 24,
          .ranks = 4,
          .functionals = 0};
}

double memory(const RunSize& size, int groups = 1, int lanes = 8) {
  return memory_estimate(size, SolverPath::lanes, groups, lanes);
}
double seconds(const RunSize& size) { return iteration_seconds_estimate(size, SolverPath::lanes); }

TEST(RunCostTest, TimeIsThatOfTheSolves) {
  RunSize size = large();
  const double one = seconds(size);
  EXPECT_GT(one, 0.0);
  size.layers *= 3;
  EXPECT_DOUBLE_EQ(seconds(size), 3.0 * one);
  size.unknowns *= 2.0;
  EXPECT_DOUBLE_EQ(seconds(size), 6.0 * one);
  size.ranks *= 2;
  EXPECT_DOUBLE_EQ(seconds(size), 3.0 * one);
  size.functionals = 4;  // beside a primal and an adjoint solve
  EXPECT_DOUBLE_EQ(seconds(size), 9.0 * one);
  EXPECT_GT(iteration_seconds_estimate(size, SolverPath::reference), 5.0 * seconds(size));
}

/// More than the fields of the layers and the vectors of the solver, and not many times as much.
TEST(RunCostTest, MemoryHoldsFieldsAndVectors) {
  const RunSize size = large();
  const double displacements = 8.0 * size.nodes * size.dimension * size.layers;
  const double densities = 8.0 * size.part_elements * size.layers;
  const double vectors = 8.0 * 8 * 8 * size.unknowns;  // eight of eight lanes
  EXPECT_GT(memory(size), displacements + densities + vectors);
  EXPECT_LT(memory(size), 5.0 * (displacements + densities + vectors));
}

TEST(RunCostTest, MemoryGrowsWithAllThatIsHeld) {
  const double one = memory(large());
  for (const auto change :
       {+[](RunSize& size) { size.unknowns *= 1.1; }, +[](RunSize& size) { size.nodes *= 1.1; },
        +[](RunSize& size) { size.part_elements *= 1.1; }, +[](RunSize& size) { ++size.layers; },
        +[](RunSize& size) { ++size.ranks; }, +[](RunSize& size) { size.functionals += 40; }}) {
    RunSize size = large();
    change(size);
    EXPECT_GT(memory(size), one);
  }
  EXPECT_GT(memory(large(), 2), one);
  for (const int lanes : {8, 4, 2})
    EXPECT_LT(memory(large(), 1, lanes / 2), memory(large(), 1, lanes)) << lanes;
  EXPECT_GT(memory_estimate(large(), SolverPath::reference, 1, 1), one);
}

template <int Dim>
RunSize size_of_run(const Config& config, const Part<Dim>& part, int layers, int ranks) {
  const auto node_sets = make_node_sets(part, config.node_sets);
  ResponseList<Dim> objective;
  for (const Term& term : config.objective)
    objective.push_back(term.type->make(term, ResponseContext<Dim>{part, node_sets, 1.0}));
  return run_size(config, part, objective, layers, ranks);
}

TEST(RunCostTest, TheSizeIsThePartsUnlessTheVoidIsQuiet) {
  const Config config = configure(solid, {{"objective.0.least_squares", "false"}});
  const test::PartOnGrid<3> half(test::odd_domain<3>(), test::gallows<3>());
  std::int64_t touched = 0;
  for (const char node : half.part.touched_nodes()) touched += node != 0 ? 1 : 0;
  const RunSize size = size_of_run(config, half.part, 7, 2);
  EXPECT_EQ(size.unknowns, 3.0 * static_cast<double>(touched));
  EXPECT_EQ(size.nodes, 6.0 * 4.0 * 6.0);
  EXPECT_LT(size.unknowns, 3.0 * size.nodes);
  EXPECT_EQ(size.part_elements, static_cast<double>(half.part.count()));
  EXPECT_EQ(size.layers, 7);
  EXPECT_EQ(size.ranks, 2);
  EXPECT_EQ(size.functionals, 0);
  const Config quiet = configure(solid, {{"process.void", "quiet"}});
  EXPECT_EQ(size_of_run(quiet, half.part, 7, 2).unknowns, 3.0 * size.nodes);
}

/// One for each component of each of the nodes sampled.
TEST(RunCostTest, FunctionalsOfSumsOfSquaresAreCounted) {
  const test::PartOnGrid<2> whole({{2.0, 1.0}, {8, 4}, 1.0}, test::box({0, 0}, {2, 1}));
  const Config config =
      configure(plane, {{"objective.0.least_squares", "true"}, {"node_sets.top.samples", "2"}});
  EXPECT_EQ(size_of_run(config, whole.part, 4, 1).functionals, 4);
  const Config alone = configure(plane, {{"objective.0.least_squares", "false"}});
  EXPECT_EQ(size_of_run(alone, whole.part, 4, 1).functionals, 0);
}

TEST(RunCostTest, LayersFollowFromHeightAndTarget) {
  const test::PartOnGrid<3> whole({{2.0, 1.0, 2.0}, {8, 4, 8}, 1.0}, test::box({0, 0, 0}, {2, 1, 2}));
  const auto count = [&](const char* target, const char* layers = "\"auto\"") {
    const Config config = configure(solid, {{"layers.count", layers}, {"constraints.0.target", target}});
    return make_layer_model(config.layers, config.projection, whole.part)->count();
  };
  EXPECT_EQ(count("0.5", "3"), 3);  // given
  const int coarse = count("0.5");
  EXPECT_GE(coarse, 4);  // 2 high; the geodesic distance reaches into the corners
  EXPECT_LE(coarse, 5);
  EXPECT_EQ(count("10"), 1);
  EXPECT_GT(count("0.25"), coarse);
  const Config config = configure(solid, {{"constraints.0.target", "0.25"}});
  const auto model = make_layer_model(config.layers, config.projection, whole.part);
  EXPECT_EQ(model->planar_count(2.0), 8);
  EXPECT_EQ(model->planar_count(0.1), 1);
}

TEST(RunCostTest, TooManyLayersAreRefused) {
  const test::PartOnGrid<3> whole({{2.0, 1.0, 2.0}, {8, 4, 8}, 1.0}, test::box({0, 0, 0}, {2, 1, 2}));
  const Config config = configure(solid, {{"layers.count", "\"auto\""}, {"constraints.0.target", "1e-6"}});
  const std::string message =
      test::refusal([&] { (void)make_layer_model(config.layers, config.projection, whole.part); });
  EXPECT_EQ(message.rfind("/constraints/0/target: found 1e-06 for a height of 2", 0), 0U) << message;
}

TEST(RunCostTest, LanesThatFitTheMemory) {
  const auto lanes = [](double unknowns, const Settings& settings = {}) {
    RunSize size = large();
    size.unknowns = unknowns;
    return resolved_lanes(PETSC_COMM_WORLD, configure(solid, settings).solver, size, 1);
  };
  EXPECT_EQ(lanes(1e3), 8);
  EXPECT_EQ(lanes(1e14), 1);  // more than any machine's memory, whatever the lanes
  EXPECT_EQ(lanes(1e14, {{"solver.lanes", "4"}}), 4);
}

TEST(RunCostTest, GroupsDivideTheRanks) {
  const Config config = configure(solid);
  const GroupChoice alone = place_part<3>(PETSC_COMM_WORLD, config)->choice;
  EXPECT_EQ(alone.groups, 1);
  EXPECT_EQ(alone.explanation, "");
  const std::string message = test::refusal([] {
    const Config divided = configure(solid, {{"solver.layer_groups", "2"}});
    (void)place_part<3>(PETSC_COMM_WORLD, divided);
  });
  EXPECT_EQ(
      message,
      "/solver/layer_groups: found 2 on 1 rank; allowed: \"auto\" or a divisor of the number of ranks (1)");
}

}  // namespace
}  // namespace fabseq
