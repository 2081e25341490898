// SPDX-License-Identifier: MIT
/// Rigid motions of stiff islands as a second coarse space.
#include "cg/lane_cg.h"
#include "islands/island_modes.h"
#include "support/islands.h"
#include "support/multigrid_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fabseq {
namespace {

/// Lanes: no island, two, none, two.
template <int Dim>
struct IslandCase {
  using Physics = test::ElasticPhysics<Dim>;
  using Problem = LaneElasticityProblem<Dim>;
  using Modes = IslandModes<Problem, 4>;
  using Solver = test::MultigridCase<Physics, 4>;

  Solver multigrid(MPI_Comm comm = PETSC_COMM_WORLD) const {
    return {comm, islands.elements, test::connected_masks<Dim>()[0], test::cycle_of(SolverCycle::v),
            [&](std::int64_t element, int lane) {
              const auto index = IndexBox<Dim>{{}, islands.elements}.index(element);
              return lane % 2 == 0 ? 0.1 + test::noise(element) : islands.stiffness(index);
            }};
  }
  static Modes modes(Solver& solver) {
    auto& matrix = solver.multigrid.finest();
    Modes result;
    EXPECT_TRUE(result.empty());
    result.set_up(matrix, IslandMap<Dim>(matrix.level()).find(matrix.coefficients(), 4));
    EXPECT_FALSE(result.empty());
    return result;
  }
  test::Islands<Dim> islands = test::two_islands<Dim>();
};

template <class T>
class IslandModesTest : public testing::Test {};
TYPED_TEST_SUITE(IslandModesTest, test::Dimensions);

/// Some rigid motion of the first island.
template <class Solver>
LaneArray motion_of(const Solver& solver, const test::Islands<Solver::Dim>& islands) {
  constexpr int Dim = Solver::Dim;
  return solver.vector([&](std::int64_t unknown, int) {
    const auto node = solver.masked.whole.nodes.index(unknown / Dim);
    if (islands.block_at(node) != 0) return 0.0;
    const auto at = [&](int axis) { return test::lane_spacing<Dim>()[axis] * node[axis]; };
    const int component = static_cast<int>(unknown % Dim);
    const std::array<double, 3> shift = {0.3, -1.1, 0.7}, turn = {0.4, -0.2, 0.5};
    double value = shift[component];
    for (int axis = 0; axis < Dim; ++axis) {  // the axis of rotation is the third one
      if (axis == component) continue;
      const int about = Dim == 2 ? 2 : 3 - axis - component;
      value += ((component + 1) % 3 == axis ? -1.0 : 1.0) * turn[about] * at(axis);
    }
    return value;
  });
}

/// Z (Z^T K Z)^-1 Z^T K z = z; nothing in lanes without islands.
TYPED_TEST(IslandModesTest, RecoverRigidMotions) {
  const IslandCase<TypeParam::value> islands;
  auto m = islands.multigrid();
  const auto modes = islands.modes(m);
  const LaneArray motion = motion_of(m, islands.islands);
  LaneArray force(motion.size()), found(motion.size(), 0.0);
  LaneValues<float> rounded(motion.size(), 0.0F);
  (void)m.multigrid.finest().apply(motion.data(), force.data());
  modes.add_correction(m.hierarchy.level(0), force.data(), found.data());
  modes.add_correction(m.hierarchy.level(0), force.data(), rounded.data());
  const LaneArray widened(rounded.begin(), rounded.end());
  for (int lane = 0; lane < 4; ++lane) {
    if (lane % 2 == 0) {
      EXPECT_EQ(test::largest(m.whole(found, lane)), 0.0);
      continue;
    }
    EXPECT_LT(test::relative_difference(m.whole(found, lane), m.whole(motion, lane)), 1e-6);
    EXPECT_LT(test::relative_difference(m.whole(widened, lane), m.whole(motion, lane)), 2e-6);
  }
}

/// Q = Z (Z^T K Z)^-1 Z^T is symmetric and Q K Q = Q.
TYPED_TEST(IslandModesTest, AreASymmetricProjection) {
  const IslandCase<TypeParam::value> islands;
  auto m = islands.multigrid();
  const auto modes = islands.modes(m);
  const auto correct = [&](const LaneArray& r) {
    LaneArray x(r.size(), 0.0);
    modes.add_correction(m.hierarchy.level(0), r.data(), x.data());
    return x;
  };
  const LaneArray a = m.random(1), b = m.random(11);
  const LaneArray qa = correct(a), qb = correct(b);
  LaneArray kqa(a.size());
  (void)m.multigrid.finest().apply(qa.data(), kqa.data());
  const LaneArray qkqa = correct(kqa);
  const auto aa = m.dot(a, qa), bb = m.dot(b, qb), ab = m.dot(a, qb), ba = m.dot(b, qa);
  for (const int lane : {1, 3}) {
    EXPECT_GT(aa[lane], 0.0);
    EXPECT_NEAR(ab[lane], ba[lane], 1e-9 * std::sqrt(aa[lane] * bb[lane]));
    EXPECT_LT(test::relative_difference(m.whole(qkqa, lane), m.whole(qa, lane)), 1e-6);
  }
}

/// What is known of the islands of the very same systems can be given to another solver.
TYPED_TEST(IslandModesTest, CanBeKept) {
  constexpr int Dim = TypeParam::value;
  const IslandCase<Dim> islands;
  auto m = islands.multigrid();
  using Solver = LaneCg<typename IslandCase<Dim>::Problem, 4>;
  typename Solver::Islands known;
  std::array<LaneArray, 2> solutions;
  for (LaneArray& solution : solutions) {
    Solver solver(m.hierarchy, m.physics.problem, test::cycle_of(SolverCycle::v));
    solver.matrix().coefficients() = m.multigrid.finest().coefficients();
    solver.set_up(known);
    ASSERT_EQ(known.size(), 4U);
    LaneArray load = m.random(1);
    solver.solve(load, solution, 4, {.tolerance = 1e-8});
  }
  EXPECT_GT(known[1]->count, 0);
  EXPECT_EQ(solutions[0], solutions[1]);
}

/// With them, conjugate gradients take fewer iterations where there are islands, and as many where there are
/// none.
TYPED_TEST(IslandModesTest, SaveIterations) {
  constexpr int Dim = TypeParam::value;
  const IslandCase<Dim> islands;
  auto m = islands.multigrid();
  std::array<std::vector<LaneOutcome>, 2> outcomes;
  for (const bool with_modes : {false, true}) {
    LaneCycle cycle = test::cycle_of(SolverCycle::v);
    cycle.islands = with_modes;
    LaneCg<typename IslandCase<Dim>::Problem, 4> solver(m.hierarchy, m.physics.problem, cycle);
    solver.matrix().coefficients() = m.multigrid.finest().coefficients();
    solver.set_up();
    LaneArray load = m.random(1), solution;
    outcomes[with_modes ? 1 : 0] = solver.solve(load, solution, 4, {.tolerance = 1e-8});
  }
  for (int lane = 0; lane < 4; ++lane) {
    EXPECT_TRUE(outcomes[1][lane].converged);
    if (lane % 2 == 0)
      EXPECT_NEAR(outcomes[0][lane].iterations, outcomes[1][lane].iterations, 1);
    else
      EXPECT_LT(outcomes[1][lane].iterations, outcomes[0][lane].iterations);
  }
}

TYPED_TEST(IslandModesTest, DoNotDependOnTheRanks) {
  const IslandCase<TypeParam::value> islands;
  auto together = islands.multigrid();
  auto alone = islands.multigrid(PETSC_COMM_SELF);
  const auto corrected = [&](auto& solver) {
    const LaneArray r = solver.random(1);
    LaneArray x(r.size(), 0.0);
    islands.modes(solver).add_correction(solver.hierarchy.level(0), r.data(), x.data());
    return x;
  };
  const LaneArray x = corrected(together), expected = corrected(alone);
  for (int lane = 0; lane < 4; ++lane)
    EXPECT_LE(test::relative_difference(together.whole(x, lane), alone.whole(expected, lane)), 1e-7) << lane;
}

}  // namespace
}  // namespace fabseq
