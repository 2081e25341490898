// SPDX-License-Identifier: MIT
/// Conjugate gradients in several lanes against known solutions: cycles, first guesses, when they stop.
#include "cg/lane_cg.h"
#include "support/lane_cg_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace fabseq {
namespace {

TYPED_TEST(LaneCgTest, SolvesAllLanes) {
  test::for_each_width([]<int Width>() {
    test::LaneCgCase<TypeParam, Width> solver;
    EXPECT_GE(solver.hierarchy.count(), 2);
    const auto outcomes = solver.solve(solver.loads(Width), Width);
    ASSERT_EQ(outcomes.size(), static_cast<std::size_t>(Width));
    for (int lane = 0; lane < Width; ++lane) {
      solver.expect_solved(outcomes[lane], lane);
      EXPECT_GT(outcomes[lane].iterations, 1);
    }
  });
}

TYPED_TEST(LaneCgTest, AllCyclesAndDegreesConverge) {
  // Ranks know nothing of degrees: one will do where messages take long.
  const bool alone = size_of(PETSC_COMM_WORLD) == 1;
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w, SolverCycle::k})
    for (const int degree : alone ? std::vector<int>{1, 2, 3, 4} : std::vector<int>{3}) {
      LaneCycle cycle;
      cycle.kind = kind;
      cycle.degree = degree;
      test::LaneCgCase<TypeParam, 2> solver(cycle);
      const auto outcomes = solver.solve(solver.loads(2), 2);
      for (int lane = 0; lane < 2; ++lane) {
        solver.expect_solved(outcomes[lane], lane);
        EXPECT_LT(outcomes[lane].iterations, 100) << static_cast<int>(kind) << " " << degree;
      }
    }
}

/// With uniform coefficients: about a digit an iteration, whatever the size.
TYPED_TEST(LaneCgTest, ConvergesFast) {
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w, SolverCycle::k}) {
    LaneCycle cycle;
    cycle.kind = kind;
    test::LaneCgCase<TypeParam, 1> solver(cycle, [](std::int64_t, int) { return 1.0; });
    const auto outcomes = solver.solve(solver.loads(1), 1, {.tolerance = 1e-8});
    EXPECT_LE(outcomes[0].iterations, TypeParam::components == 1 ? 8 : 11) << static_cast<int>(kind);
  }
}

TYPED_TEST(LaneCgTest, AFewElementsAreSolvedDirectly) {
  Index<TypeParam::Dim> size;
  size.fill(5);
  test::LaneCgCase<TypeParam, 4> solver({}, test::moderate<TypeParam>, PETSC_COMM_WORLD,
                                        test::masks<TypeParam::Dim>()[0], size);
  const auto outcomes = solver.solve(solver.loads(4), 4);
  for (int lane = 0; lane < 4; ++lane) {
    solver.expect_solved(outcomes[lane], lane);
    EXPECT_LE(outcomes[lane].iterations, 2);
  }
}

TYPED_TEST(LaneCgTest, StopsAtTheIterationLimit) {
  test::LaneCgCase<TypeParam, 4> solver;
  const auto outcomes = solver.solve(solver.loads(4), 4, {.tolerance = 1e-12, .max_iterations = 2});
  for (const LaneOutcome& outcome : outcomes) {
    EXPECT_FALSE(outcome.converged);
    EXPECT_TRUE(outcome.finite);
    EXPECT_EQ(outcome.iterations, 2);
    EXPECT_GT(outcome.residual, 1e-12);
    EXPECT_LT(outcome.residual, 1.0);
  }
}

/// A guess near the solution saves steps, and leads to the same one; 0 is none.
TYPED_TEST(LaneCgTest, ImprovesAGuess) {
  if constexpr (TypeParam::Problem::own_operators) {
    test::LaneCgCase<TypeParam, 4> solver;
    const LaneArray loads = solver.loads(4, [](int lane) { return lane == 2 ? 1e6 : 1.0; });
    const auto cold = solver.solve(loads, 4);
    // The same for all holders of a node.
    for (std::size_t i = 0; i < solver.solution.size(); ++i)
      solver.solution[i] *=
          i % 4 == 3 ? 0.0 : 1.0 + 0.01 * static_cast<double>(i / 4 % TypeParam::components);
    LaneScalars<4> smallest;
    for (int lane = 0; lane < 4; ++lane) smallest[lane] = cold[lane].smallest;
    LaneArray load = loads;
    const auto warm = solver.cg.improve(load, solver.solution, 4, {.tolerance = 1e-9}, smallest);
    for (int lane = 0; lane < 4; ++lane) {
      EXPECT_LE(warm[lane].smallest, smallest[lane]) << lane;
      EXPECT_EQ(warm[lane].iterations < cold[lane].iterations, lane != 3) << lane;
      solver.expect_solved(warm[lane], lane, lane == 2 ? 1e6 : 1.0);
    }
  }
}

/// Only the best multiple of a guess counts: loads may have changed by far, or have vanished.
TYPED_TEST(LaneCgTest, AGuessIsNoWorseThanNone) {
  if constexpr (TypeParam::Problem::own_operators) {
    test::LaneCgCase<TypeParam, 4> solver;
    const auto cold = solver.solve(solver.loads(4), 4);
    enum { vanished, longer, unlike, opposite };
    const LaneArray other = solver.loads(4);
    for (std::size_t i = 0; i < solver.solution.size(); ++i) {
      if (i % 4 == longer) solver.solution[i] *= 1e8;
      if (i % 4 == opposite) solver.solution[i] *= -1.0;
      if (i % 4 == unlike) solver.solution[i] = other[i];
    }
    LaneScalars<4> smallest;
    for (int lane = 0; lane < 4; ++lane) smallest[lane] = cold[lane].smallest;
    LaneArray load = solver.loads(4, [](int lane) { return lane == vanished ? 0.0 : 1.0; });
    const auto warm = solver.cg.improve(load, solver.solution, 4, {.tolerance = 1e-9}, smallest);
    for (int lane = 0; lane < 4; ++lane) solver.expect_solved(warm[lane], lane, lane == vanished ? 0.0 : 1.0);
    EXPECT_EQ(warm[vanished].iterations, 0);
    EXPECT_LE(warm[longer].iterations, 1);
    EXPECT_LE(warm[opposite].iterations, 1);
    EXPECT_LE(warm[unlike].iterations, cold[unlike].iterations + 3);
  }
}

/// That saves a cycle of the multigrid and leaves the errors as they are.
TYPED_TEST(LaneCgTest, AResidualWithinReachIsFollowedByOneStep) {
  test::LaneCgCase<TypeParam, 4> solver;
  const LaneArray loads = solver.loads(4);
  std::vector<double> errors;
  const auto solve = [&](double reach) {
    const auto outcomes = solver.solve(loads, 4, {.tolerance = 1e-6, .reach = reach});
    errors.clear();
    for (int lane = 0; lane < 4; ++lane)
      errors.push_back(test::relative_difference(solver.whole(lane), solver.expected(lane)));
    return outcomes;
  };
  const auto strict = solve(1.0);
  const std::vector<double> strict_errors = errors;
  const auto reaching = solve(3.0);
  for (int lane = 0; lane < 4; ++lane) {
    EXPECT_TRUE(reaching[lane].converged);
    EXPECT_LE(reaching[lane].iterations, strict[lane].iterations);
    EXPECT_LE(reaching[lane].residual, 3e-6);
    EXPECT_LT(errors[lane], 5.0 * strict_errors[lane]);
  }
  for (const LaneOutcome& outcome : solve(1e9)) EXPECT_EQ(outcome.iterations, 1);
  for (int lane = 0; lane < 4; ++lane) EXPECT_GT(test::largest(solver.whole(lane)), 0.0);
}

/// The first direction of conjugate gradients, which a step of theirs follows.
TYPED_TEST(LaneCgTest, OneCycleGivesTheFirstDirection) {
  test::LaneCgCase<TypeParam, 4> solver;
  const LaneArray loads = solver.loads(4, [](int lane) { return std::exp2(4.0 * lane); });
  const auto solve = [&](bool one_cycle) {
    std::vector<std::vector<double>> solutions;
    for (const LaneOutcome& outcome :
         solver.solve(loads, 3, {.tolerance = 1e-6, .reach = 1e9, .one_cycle = one_cycle})) {
      EXPECT_TRUE(outcome.converged);
      EXPECT_EQ(outcome.iterations, 1);
      solutions.push_back(solver.whole(static_cast<int>(solutions.size())));
    }
    return solutions;
  };
  const auto cycles = solve(true), steps = solve(false);
  for (std::size_t lane = 0; lane < steps.size(); ++lane) {
    const std::vector<double>&a = cycles[lane], &b = steps[lane];
    const double overlap = std::inner_product(a.begin(), a.end(), b.begin(), 0.0),
                 square = std::inner_product(a.begin(), a.end(), a.begin(), 0.0);
    std::vector<double> scaled = a;
    for (double& value : scaled) value *= overlap / square;
    EXPECT_LT(test::relative_difference(scaled, b), 1e-5);
    EXPECT_NEAR(overlap / square, 1.0, 0.5);
  }
}

TYPED_TEST(LaneCgTest, IterationsDoNotDependOnTheRanks) {
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w, SolverCycle::k}) {
    LaneCycle cycle;
    cycle.kind = kind;
    test::LaneCgCase<TypeParam, 4> together(cycle), alone(cycle, test::moderate<TypeParam>, PETSC_COMM_SELF);
    const auto outcomes = together.solve(together.loads(4), 4);
    const auto expected = alone.solve(alone.loads(4), 4);
    for (int lane = 0; lane < 4; ++lane) {
      EXPECT_NEAR(outcomes[lane].iterations, expected[lane].iterations, 1) << static_cast<int>(kind);
      EXPECT_LT(test::relative_difference(together.whole(lane), alone.whole(lane)), 1e-6);
    }
  }
}

/// The same solver for one load after the other, and for other coefficients.
TYPED_TEST(LaneCgTest, CanBeUsedAgain) {
  if (size_of(PETSC_COMM_WORLD) > 1) GTEST_SKIP() << "ranks: one rank will do";
  test::LaneCgCase<TypeParam, 4> solver({}, [](std::int64_t, int) { return 1.0; });
  (void)solver.solve(solver.loads(4), 4);
  solver.coefficient = test::moderate<TypeParam>;
  solver.cg.matrix().coefficients() = test::coefficient_array(
      solver.hierarchy.level(0).mesh, solver.masked.grid.all_elements(), solver.stride, solver.coefficient);
  solver.cg.set_up();
  for (const int lanes : {4, 3, 1}) {
    const auto outcomes = solver.solve(solver.loads(lanes), lanes);
    for (int lane = 0; lane < lanes; ++lane) solver.expect_solved(outcomes[lane], lane);
  }
}

}  // namespace
}  // namespace fabseq
