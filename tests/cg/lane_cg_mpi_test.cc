// SPDX-License-Identifier: MIT
/// Conjugate gradients in several lanes against known solutions: loads are sums over the elements one by one.
#include "cg/lane_cg.h"
#include "support/islands.h"
#include "support/lane_physics.h"
#include "support/masked_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

namespace fabseq {
namespace {

template <int Dim>
Index<Dim> odd_size() {
  if constexpr (Dim == 2)
    return {51, 49};
  else
    return {11, 9, 8};
}

/// A coefficient of an element and lane (or entry, for heat).
using Coefficient = std::function<double(std::int64_t, int)>;

/// Three decades.
template <class Physics>
double moderate(std::int64_t element, int entry) {
  return std::pow(Physics::coefficient(element, entry), 1.0 / 3.0);
}

/// A solver and loads of known solutions.
template <class Physics, int Width>
struct Solver {
  static constexpr int Dim = Physics::Dim;
  static constexpr int components = Physics::components;
  using Problem = typename Physics::Problem;
  static constexpr int stride = Problem::template Kernel<Width>::stride;

  explicit Solver(const LaneCycle& cycle = {}, const Coefficient& coefficient_ = moderate<Physics>,
                  MPI_Comm comm_ = PETSC_COMM_WORLD, const test::Mask<Dim>& mask = test::masks<Dim>()[0],
                  const Index<Dim>& size = odd_size<Dim>())
      : comm(comm_),
        coefficient(coefficient_),
        masked(comm, size, mask, components, test::MaskedGrid<Dim>::on_plate(size, {Dim - 1, false})),
        touching(masked.whole.touching_elements()),
        hierarchy(masked.grid, masked.domain),
        cg(hierarchy, physics.problem, cycle) {
    cg.matrix().coefficients() =
        test::coefficient_array(hierarchy.level(0).mesh, masked.grid.all_elements(), stride, coefficient);
    cg.set_up();
  }

  /// On all nodes of the grid.
  std::vector<double> expected(int lane) const {
    std::vector<double> result;
    for (std::int64_t i = 0; i < masked.whole.nodes.count() * components; ++i) {
      const auto node = masked.whole.nodes.index(i / components);
      const bool is_free = touching[i / components] > 0 && node[Dim - 1] != 0;
      result.push_back(is_free ? test::noise(i, lane) - 0.5 : 0.0);
    }
    return result;
  }
  std::vector<double> load(int lane) const {
    return test::multiply(
               masked.whole, components,
               [&](std::int64_t element) {
                 return physics.matrix_with(
                     [&](int entry) { return coefficient(element, Problem::own_operators ? lane : entry); });
               },
               expected(lane))
        .value;
  }
  /// The loads of `lanes` lanes, times `factor(lane)`.
  LaneArray loads(
      int lanes, const std::function<double(int)>& factor = [](int) { return 1.0; }) const {
    std::vector<std::vector<double>> all;
    for (int lane = 0; lane < lanes; ++lane) all.push_back(load(lane));
    return test::lane_array(hierarchy.level(0).mesh, masked.whole.nodes, components, Width,
                            [&](std::int64_t unknown, int lane) {
                              return lane < lanes ? factor(lane) * all[lane][unknown] : 0.0;
                            });
  }
  std::vector<LaneOutcome> solve(LaneArray load, int lanes, const LaneStop& stop = {.tolerance = 1e-9}) {
    return cg.solve(load, solution, lanes, stop);
  }
  std::vector<double> whole(int lane) const {
    return test::whole_lane(comm, hierarchy.level(0).mesh, masked.whole.nodes, solution, components, Width,
                            lane);
  }
  void expect_solved(const LaneOutcome& outcome, int lane, double factor = 1.0) const {
    EXPECT_TRUE(outcome.converged) << lane;
    EXPECT_TRUE(outcome.finite) << lane;
    EXPECT_LE(outcome.residual, 1e-9) << lane;
    auto wanted = expected(lane);
    for (double& value : wanted) value *= factor;
    EXPECT_LT(test::relative_difference(whole(lane), wanted), 1e-6) << lane;
  }

  MPI_Comm comm;
  Coefficient coefficient;
  test::MaskedGrid<Dim> masked;
  std::vector<int> touching;
  LaneHierarchy<Dim> hierarchy;
  Physics physics;
  LaneCg<Problem, Width> cg;
  LaneArray solution;
};

template <class T>
class LaneCgTest : public testing::Test {};
TYPED_TEST_SUITE(LaneCgTest, test::AllPhysics);

TYPED_TEST(LaneCgTest, SolvesAllLanes) {
  test::for_each_width([]<int Width>() {
    Solver<TypeParam, Width> solver;
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
      Solver<TypeParam, 2> solver(cycle);
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
    Solver<TypeParam, 1> solver(cycle, [](std::int64_t, int) { return 1.0; });
    const auto outcomes = solver.solve(solver.loads(1), 1, {.tolerance = 1e-8});
    EXPECT_LE(outcomes[0].iterations, TypeParam::components == 1 ? 8 : 11) << static_cast<int>(kind);
  }
}

TYPED_TEST(LaneCgTest, AFewElementsAreSolvedDirectly) {
  Index<TypeParam::Dim> size;
  size.fill(5);
  Solver<TypeParam, 4> solver({}, moderate<TypeParam>, PETSC_COMM_WORLD, test::masks<TypeParam::Dim>()[0],
                              size);
  const auto outcomes = solver.solve(solver.loads(4), 4);
  for (int lane = 0; lane < 4; ++lane) {
    solver.expect_solved(outcomes[lane], lane);
    EXPECT_LE(outcomes[lane].iterations, 2);
  }
}

TYPED_TEST(LaneCgTest, LanesWithoutLoadStayZeroAndDisturbNobody) {
  Solver<TypeParam, 8> solver;
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
  Solver<TypeParam, 4> solver;
  const auto factor = [](int lane) { return std::pow(10.0, 6.0 * lane - 12.0); };
  const auto outcomes = solver.solve(solver.loads(4, factor), 4);
  for (int lane = 0; lane < 4; ++lane) solver.expect_solved(outcomes[lane], lane, factor(lane));
}

TYPED_TEST(LaneCgTest, LanesThatAreNotAskedForAreIgnored) {
  if (size_of(PETSC_COMM_WORLD) > 1) GTEST_SKIP() << "ranks: one rank will do";
  Solver<TypeParam, 8> solver;
  LaneArray loads = solver.loads(5);
  for (std::size_t i = 0; i < loads.size(); ++i)
    if (i % 8 >= 5) loads[i] = i % 8 == 6 ? NAN : 1.0;
  const auto outcomes = solver.solve(loads, 5);
  ASSERT_EQ(outcomes.size(), 5u);
  for (int lane = 0; lane < 5; ++lane) solver.expect_solved(outcomes[lane], lane);
}

TYPED_TEST(LaneCgTest, ALoadThatIsNoNumberIsReported) {
  for (const double spoiled : {static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    Solver<TypeParam, 4> solver;
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
  Solver<Physics, 4> good;
  Solver<Physics, 4> solver({}, [&](std::int64_t element, int lane) {
    return lane == 1 && element % 7 == 0 ? spoiled : moderate<Physics>(element, lane);
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

TYPED_TEST(LaneCgTest, StopsAtTheIterationLimit) {
  Solver<TypeParam, 4> solver;
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
    Solver<TypeParam, 4> solver;
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
    Solver<TypeParam, 4> solver;
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
  Solver<TypeParam, 4> solver;
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

/// A lane with islands goes to a tolerance of its own, also when it goes on in a narrower solver; the others
/// make one step.
TEST(LaneCgOperatorTest, LanesWithIslandsHaveAToleranceOfTheirOwn) {
  const auto islands = test::two_islands<3>();
  const IndexBox<3> elements{{}, islands.elements};
  const auto coefficient = [&](std::int64_t element, int lane) {
    return lane == 1 ? islands.stiffness(elements.index(element)) : 1.0;
  };
  Solver<test::ElasticPhysics<3>, 4> solver({}, coefficient, PETSC_COMM_WORLD, test::masks<3>()[0],
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
  Solver<Physics, 8> together({}, harder);
  const auto outcomes = together.solve(together.loads(8), 8);
  EXPECT_GT(outcomes[7].iterations, 2 * outcomes[0].iterations);
  for (int lane = 0; lane < 8; ++lane) {
    SCOPED_TRACE(lane);
    Solver<Physics, 1> alone({}, [&](std::int64_t element, int) { return harder(element, lane); });
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

TYPED_TEST(LaneCgTest, IterationsDoNotDependOnTheRanks) {
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w, SolverCycle::k}) {
    LaneCycle cycle;
    cycle.kind = kind;
    Solver<TypeParam, 4> together(cycle), alone(cycle, moderate<TypeParam>, PETSC_COMM_SELF);
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
  Solver<TypeParam, 4> solver({}, [](std::int64_t, int) { return 1.0; });
  (void)solver.solve(solver.loads(4), 4);
  solver.coefficient = moderate<TypeParam>;
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
