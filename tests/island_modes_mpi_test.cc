/// Rigid motions of stiff islands as a part of the multigrid cycle.
#include "fabseq/solve/island_modes.h"

#include <gtest/gtest.h>

#include "support/islands.h"
#include "support/multigrid_case.h"
#include <cmath>
#include <vector>

namespace fabseq {
namespace {

/// Lanes: no island, two, none, two.
template <int Dim>
struct IslandCase {
  using Solver = test::MultigridCase<test::ElasticPhysics<Dim>, 4>;

  Solver multigrid(bool with_modes, MPI_Comm comm = PETSC_COMM_WORLD) const {
    LaneCycle cycle = test::cycle_of(SolverCycle::v);
    cycle.islands = with_modes;
    return {comm, islands.elements, test::connected_masks<Dim>()[0], cycle,
            [&](std::int64_t element, int lane) {
              const auto index = IndexBox<Dim>{{}, islands.elements}.index(element);
              return lane % 2 == 0 ? 0.1 + test::noise(element) : islands.stiffness(index);
            }};
  }
  test::Islands<Dim> islands = test::two_islands<Dim>();
};

template <class T>
class IslandModesTest : public testing::Test {};
TYPED_TEST_SUITE(IslandModesTest, test::Dimensions);

TYPED_TEST(IslandModesTest, KeepTheCycleSymmetricAndPositive) {
  const IslandCase<TypeParam::value> islands;
  auto m = islands.multigrid(true);
  m.expect_symmetric_and_positive(1e-9);
}

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
  constexpr int Dim = TypeParam::value;
  const IslandCase<Dim> islands;
  auto m = islands.multigrid(true);
  auto& level = m.hierarchy.level(0);
  auto& matrix = m.multigrid.finest();
  LaneArray first(matrix.size()), second(matrix.size());
  IslandModes<LaneElasticityProblem<Dim>, 4> modes;
  EXPECT_TRUE(modes.empty());
  modes.set_up(matrix, IslandMap<Dim>(level).find(matrix.coefficients(), 4), first, second);
  EXPECT_FALSE(modes.empty());
  const LaneArray motion = motion_of(m, islands.islands);
  LaneArray force(motion.size()), part(motion.size(), 0.0), found(motion.size(), 0.0);
  (void)matrix.apply(motion.data(), force.data());
  for (const auto& range : level.counted)  // one holder's part is the whole, the others' nothing
    std::copy(force.begin() + range.begin * Dim * 4, force.begin() + range.end * Dim * 4,
              part.begin() + range.begin * Dim * 4);
  modes.add_correction(level, part.data(), found.data());
  for (int lane = 0; lane < 4; ++lane) {
    if (lane % 2 == 0)
      EXPECT_EQ(test::largest(m.whole(found, lane)), 0.0);
    else
      EXPECT_LT(test::relative_difference(m.whole(found, lane), m.whole(motion, lane)), 1e-6);
  }
}

/// x . K M K x is at least x . K x for a rigid motion x of an island, which the coarse levels alone do not
/// reach. Other lanes do not notice.
TYPED_TEST(IslandModesTest, MakeTheCycleSeeRigidMotions) {
  const IslandCase<TypeParam::value> islands;
  auto with = islands.multigrid(true), without = islands.multigrid(false);
  const LaneArray motion = motion_of(with, islands.islands);
  LaneArray force(motion.size());
  (void)with.multigrid.finest().apply(motion.data(), force.data());
  const auto quotient = [&](auto& m, int lane) {
    return m.dot(force, m.apply(force))[lane] / m.dot(force, motion)[lane];
  };
  for (const int lane : {1, 3}) {
    EXPECT_GT(quotient(with, lane), 0.99);
    EXPECT_GT(quotient(with, lane), quotient(without, lane) + 0.03);
  }
  const LaneArray one = with.apply(force), other = without.apply(force);
  for (std::size_t i = 0; i < one.size(); i += 2) EXPECT_EQ(one[i], other[i]);
}

TYPED_TEST(IslandModesTest, DoNotDependOnTheRanks) {
  constexpr int Dim = TypeParam::value;
  const IslandCase<Dim> islands;
  auto together = islands.multigrid(true);
  auto alone = islands.multigrid(true, PETSC_COMM_SELF);
  const LaneArray x = together.apply(together.random(1)), expected = alone.apply(alone.random(1));
  for (int lane = 0; lane < 4; ++lane)
    EXPECT_LT(test::relative_difference(together.whole(x, lane), alone.whole(expected, lane)), 1e-7) << lane;
}

}  // namespace
}  // namespace fabseq
