// SPDX-License-Identifier: MIT
/// Lanes of conjugate gradients do not disturb each other: sizes of loads, lanes that are not asked for, what
/// is no number, islands, lanes that take longer.
#include "cg/lane_cg.h"
#include "support/islands.h"
#include "support/lane_cg_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fabseq {
namespace {

TYPED_TEST(LaneCgTest, LanesWithoutLoadStayZeroAndDisturbNobody) {
  test::LaneCgCase<TypeParam, 8> solver;
  const auto loaded = [](int lane) { return lane == 2 || lane == 5 || lane == 7 ? 1.0 : 0.0; };
  const auto outcomes = solver.solve(solver.loads(8, loaded), 8);
  for (int lane = 0; lane < 8; ++lane) {
    if (loaded(lane) != 0.0) {
      solver.expect_solved(outcomes[lane], lane);
      continue;
    }
    EXPECT_TRUE(outcomes[lane].converged);
    EXPECT_EQ(outcomes[lane].iterations, 0);
    EXPECT_EQ(outcomes[lane].residual, 0.0);
    EXPECT_EQ(test::largest(solver.whole(lane)), 0.0);
  }
}

/// Loads and solutions of very different size: each lane has a test of its own.
TYPED_TEST(LaneCgTest, SizesOfLoadsDoNotMatter) {
  if (size_of(PETSC_COMM_WORLD) > 1) GTEST_SKIP() << "ranks: one rank will do";
  test::LaneCgCase<TypeParam, 4> solver;
  const auto factor = [](int lane) { return std::pow(10.0, 6.0 * lane - 12.0); };
  const auto outcomes = solver.solve(solver.loads(4, factor), 4);
  for (int lane = 0; lane < 4; ++lane) solver.expect_solved(outcomes[lane], lane, factor(lane));
}

TYPED_TEST(LaneCgTest, LanesThatAreNotAskedForAreIgnored) {
  if (size_of(PETSC_COMM_WORLD) > 1) GTEST_SKIP() << "ranks: one rank will do";
  test::LaneCgCase<TypeParam, 8> solver;
  LaneArray loads = solver.loads(5);
  for (std::size_t i = 0; i < loads.size(); ++i)
    if (i % 8 >= 5) loads[i] = i % 8 == 6 ? NAN : 1.0;
  const auto outcomes = solver.solve(loads, 5);
  ASSERT_EQ(outcomes.size(), 5u);
  for (int lane = 0; lane < 5; ++lane) solver.expect_solved(outcomes[lane], lane);
}

TYPED_TEST(LaneCgTest, ALoadThatIsNoNumberIsReported) {
  for (const double spoiled : {static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    test::LaneCgCase<TypeParam, 4> solver;
    LaneArray loads = solver.loads(4);
    // On one rank only.
    if (rank_of(PETSC_COMM_WORLD) == 0 && !solver.hierarchy.level(0).counted.empty()) {
      const auto free = solver.hierarchy.level(0).counted.back().end - 1;
      loads[(free * TypeParam::components) * 4 + 1] = spoiled;
    }
    const auto outcomes = solver.solve(loads, 4);
    for (int lane = 0; lane < 4; ++lane) {
      if (lane != 1) {
        solver.expect_solved(outcomes[lane], lane);
        continue;
      }
      EXPECT_FALSE(outcomes[lane].converged);
      EXPECT_FALSE(outcomes[lane].finite);
      EXPECT_FALSE(std::isfinite(outcomes[lane].residual)) << "a residual of what is no number";
    }
  }
}

template <class Physics>
void expect_only_lane_1_fails(double spoiled, bool finite) {
  test::LaneCgCase<Physics, 4> good;
  test::LaneCgCase<Physics, 4> solver({}, [&](std::int64_t element, int lane) {
    return lane == 1 && element % 7 == 0 ? spoiled : test::moderate<Physics>(element, lane);
  });
  const auto outcomes = solver.solve(good.loads(4), 4);
  for (int lane = 0; lane < 4; ++lane) {
    if (lane != 1) {
      solver.expect_solved(outcomes[lane], lane);
      continue;
    }
    EXPECT_FALSE(outcomes[lane].converged);
    EXPECT_EQ(outcomes[lane].finite, finite);
  }
}

TEST(LaneCgOperatorTest, AStiffnessThatIsNoNumberIsReported) {
  expect_only_lane_1_fails<test::ElasticPhysics<2>>(NAN, false);
  expect_only_lane_1_fails<test::ElasticPhysics<3>>(NAN, false);
}

TEST(LaneCgOperatorTest, ALaneThatIsNotPositiveDefiniteIsReported) {
  expect_only_lane_1_fails<test::ElasticPhysics<2>>(-100.0, true);
  expect_only_lane_1_fails<test::ElasticPhysics<3>>(-100.0, true);
}

/// A lane with islands goes to a tolerance of its own, also when it goes on in a narrower solver; the others
/// make one step.
TEST(LaneCgOperatorTest, LanesWithIslandsHaveAToleranceOfTheirOwn) {
  const auto islands = test::two_islands<3>();
  const IndexBox<3> elements{{}, islands.elements};
  const auto coefficient = [&](std::int64_t element, int lane) {
    return lane == 1 ? islands.stiffness(elements.index(element)) : 1.0;
  };
  test::LaneCgCase<test::ElasticPhysics<3>, 4> solver({}, coefficient, PETSC_COMM_WORLD, test::masks<3>()[0],
                                                      islands.elements);
  const LaneArray loads = solver.loads(4);
  for (const double of_islands : {0.0, 1e-6}) {
    const auto outcomes = solver.solve(loads, 4, {.tolerance = 0.5, .reach = 4.0, .of_islands = of_islands});
    for (int lane = 0; lane < 4; ++lane) {
      EXPECT_EQ(outcomes[lane].has_islands, lane == 1);
      EXPECT_TRUE(lane == 1 || outcomes[lane].iterations == 1);
    }
    const double error = test::relative_difference(solver.whole(1), solver.expected(1));
    EXPECT_EQ(error<1e-4, of_islands> 0.0) << error;
  }
}

/// Lanes that need very different numbers of iterations: they go on in narrower and narrower solvers, with
/// the results of one lane by itself.
TEST(LaneCgOperatorTest, EveryLaneEndsAsIfItWereAlone) {
  if (size_of(PETSC_COMM_WORLD) > 2) GTEST_SKIP() << "ranks: one and two ranks will do";
  using Physics = test::ElasticPhysics<2>;
  const auto harder = [](std::int64_t element, int lane) {
    return std::pow(10.0, -0.8 * lane * test::noise(element, 3));
  };
  test::LaneCgCase<Physics, 8> together({}, harder);
  const auto outcomes = together.solve(together.loads(8), 8);
  EXPECT_GT(outcomes[7].iterations, 2 * outcomes[0].iterations);
  for (int lane = 0; lane < 8; ++lane) {
    SCOPED_TRACE(lane);
    test::LaneCgCase<Physics, 1> alone({}, [&](std::int64_t element, int) { return harder(element, lane); });
    const std::vector<double> load = together.load(lane);
    const auto outcome =
        alone.solve(test::lane_array(alone.hierarchy.level(0).mesh, alone.masked.whole.nodes, 2, 1,
                                     [&](std::int64_t unknown, int) { return load[unknown]; }),
                    1);
    EXPECT_EQ(outcomes[lane].converged, outcome[0].converged);
    EXPECT_NEAR(outcomes[lane].iterations, outcome[0].iterations, 1);
    EXPECT_LT(test::relative_difference(together.whole(lane), alone.whole(0)), 1e-6);
  }
}

}  // namespace
}  // namespace fabseq
