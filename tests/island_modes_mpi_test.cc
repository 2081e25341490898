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

/// x . K M K x is at least x . K x for a rigid motion x of an island, which the coarse levels alone do not
/// reach. Other lanes do not notice.
TYPED_TEST(IslandModesTest, SolveRigidMotions) {
  constexpr int Dim = TypeParam::value;
  const IslandCase<Dim> islands;
  auto with = islands.multigrid(true), without = islands.multigrid(false);
  for (const int rotation : {0, 1}) {
    const auto motion = with.vector([&](std::int64_t unknown, int) {
      const auto node = with.masked.whole.nodes.index(unknown / Dim);
      const int component = static_cast<int>(unknown % Dim);
      if (islands.islands.block_at(node) != 0) return 0.0;
      const auto spacing = test::lane_spacing<Dim>();
      if (rotation == 0) return component == 1 ? 1.0 : 0.5;
      if (component == 0) return -spacing[1] * node[1];
      return component == 1 ? spacing[0] * node[0] : 0.0;
    });
    LaneArray force(motion.size());
    (void)with.multigrid.finest().apply(motion.data(), force.data());
    const auto quotient = [&](auto& m, int lane) {
      return m.dot(force, m.apply(force))[lane] / m.dot(force, motion)[lane];
    };
    for (const int lane : {1, 3}) {
      EXPECT_GT(quotient(with, lane), 0.99) << rotation;
      EXPECT_GT(quotient(with, lane), quotient(without, lane) + 0.03) << rotation;
    }
    const LaneArray one = with.apply(force), other = without.apply(force);
    for (std::size_t i = 0; i < one.size(); i += 2) EXPECT_EQ(one[i], other[i]);
  }
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
