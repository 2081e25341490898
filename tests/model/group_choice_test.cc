// SPDX-License-Identifier: MIT
/// Layer groups on fewer cores than ranks.
#include "fabseq/model/group_choice.h"

#include "fabseq/model/run_cost.h"
#include "support/small_configs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace fabseq {
namespace {

RunSize size_with(int ranks, double cores, int layers) {
  return {.unknowns = 1.5e6,
          .nodes = 1e6,
          .part_elements = 4.5e5,
          .dimension = 3,
          .layers = layers,
          .ranks = ranks,
          .functionals = 0,
          .cores_per_rank = std::min(1.0, cores / ranks)};
}

double time_of(const RunSize& size, int groups) {
  return relative_time_estimate(size, SolverPath::lanes, groups);
}

double best_time(const RunSize& size) {
  double best = time_of(size, 1);
  for (int groups = 2; groups <= size.ranks; ++groups)
    if (size.ranks % groups == 0) best = std::min(best, time_of(size, groups));
  return best;
}

TEST(GroupChoiceTest, EnoughCoresChangeNothing) {
  for (const int groups : {1, 2, 4})
    EXPECT_EQ(time_of(size_with(4, 4.0, 24), groups), time_of(size_with(4, 64.0, 24), groups));
}

/// However they are divided, ranks that share two cores are at most twice as fast as one, and slower than
/// ranks with cores of their own. Two groups of unlike work on two cores may be slower than four, which share
/// the cores evenly.
TEST(GroupChoiceTest, RanksThatShareCoresAreNoFasterThanTheCores) {
  for (const int layers : {3, 8, 16, 24, 25}) {
    const double one = time_of(size_with(1, 1.0, layers), 1);
    for (const int ranks : {2, 4, 8}) {
      const double shared = best_time(size_with(ranks, 2.0, layers));
      EXPECT_GE(shared, 0.5 * one) << layers << " layers, " << ranks << " ranks";
      EXPECT_GE(shared, best_time(size_with(ranks, ranks, layers))) << layers << " layers, " << ranks;
      EXPECT_GE(best_time(size_with(ranks, 1.0, layers)), one) << layers << " layers, " << ranks << " ranks";
    }
  }
}

/// Halved blocks take two cores less long than a whole one, but fill the registers less: on a single core
/// that is lost.
TEST(GroupChoiceTest, GroupsPayForHalvedBlocksWhereCoresAreFew) {
  const double idle = time_of(size_with(2, 2.0, 8), 2), shared = time_of(size_with(2, 1.0, 8), 2);
  EXPECT_GT(shared, 1.8 * idle);
  EXPECT_GT(shared, time_of(size_with(1, 1.0, 8), 1));
  // Of three blocks one group has two; on one core the other leaves it the core when it is done.
  EXPECT_NEAR(time_of(size_with(2, 1.0, 24), 2), time_of(size_with(1, 1.0, 24), 1),
              0.1 * time_of(size_with(1, 1.0, 24), 1));
}

TEST(GroupChoiceTest, TheExplanationCountsCores) {
  const Config config = configure(solid);
  const auto explained = [&](int ranks, double cores) {
    return fastest_choice<3>(config, size_with(ranks, cores, 16), 1e12).explanation;
  };
  EXPECT_EQ(explained(2, 2.0).find("cores"), std::string::npos);
  const std::string shared = explained(4, 2.0);
  EXPECT_NE(shared.find("; 0.5 cores a rank"), std::string::npos) << shared;
  EXPECT_NE(explained(2, 2.0).find("2 x 1 ranks (auto): 1.9 times as fast as one rank"), std::string::npos);
  EXPECT_NE(explained(2, 1.0).find("2 x 1 ranks (auto): 1.0 times as fast as one rank"), std::string::npos);
}

TEST(GroupChoiceTest, EstimatedSecondsAreThoseOfTheCores) {
  const auto seconds = [](int ranks, double cores) {
    return iteration_seconds_estimate(size_with(ranks, cores, 24), SolverPath::lanes);
  };
  EXPECT_DOUBLE_EQ(seconds(4, 2.0), seconds(2, 2.0));
  EXPECT_DOUBLE_EQ(seconds(4, 4.0), 0.5 * seconds(2, 2.0));
}

}  // namespace
}  // namespace fabseq
