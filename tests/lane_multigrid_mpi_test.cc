/// The lane multigrid as a linear operator: symmetric, positive definite, the same on any number of ranks.
#include "fabseq/solve/lane_multigrid.h"
#include "fabseq/solve/lane_multigrid_impl.h"

#include <gtest/gtest.h>

#include "support/lane_physics.h"
#include "support/masked_grid.h"
#include <vector>

namespace fabseq {
namespace {

/// Three levels or more; the first two of the large ones are distributed.
template <int Dim>
Index<Dim> odd_size() {
  if constexpr (Dim == 2)
    return {61, 53};
  else
    return {19, 15, 17};
}
template <int Dim>
Index<Dim> large_size() {
  if constexpr (Dim == 2)
    return {96, 96};
  else
    return {24, 24, 24};
}
/// Everything is supported with these.
template <int Dim>
std::vector<test::Mask<Dim>> connected_masks() {
  return {test::masks<Dim>()[0], test::masks<Dim>()[3]};
}

template <class Physics, int Width>
struct Multigrid {
  static constexpr int Dim = Physics::Dim;
  static constexpr int components = Physics::components;
  using Kernel = typename Physics::Problem::template Kernel<Width>;

  /// `coefficient` of an element of the grid and an entry.
  template <class Coefficient>
  Multigrid(MPI_Comm comm_, const Index<Dim>& size, const test::Mask<Dim>& mask, const LaneCycle& cycle,
            Coefficient&& coefficient)
      : comm(comm_),
        masked(comm, size, mask, components, test::MaskedGrid<Dim>::on_plate(size, {Dim - 1, false})),
        touching(masked.whole.touching_elements()),
        hierarchy(masked.grid, masked.domain),
        multigrid(hierarchy, physics.problem, cycle) {
    multigrid.finest().coefficients() = test::coefficient_array(
        hierarchy.level(0).mesh, masked.grid.all_elements(), Kernel::stride, coefficient);
    positive = multigrid.set_up();
  }
  Multigrid(MPI_Comm comm_, const Index<Dim>& size, const test::Mask<Dim>& mask, const LaneCycle& cycle)
      : Multigrid(comm_, size, mask, cycle, [](std::int64_t element, int entry) {
          return std::pow(Physics::coefficient(element, entry), 1.0 / 3.0);  // three decades
        }) {}

  bool is_free(std::int64_t unknown) const {
    const auto node = masked.whole.nodes.index(unknown / components);
    return touching[unknown / components] > 0 && node[Dim - 1] != 0;
  }
  template <class Function>
  LaneArray vector(Function&& f) const {
    return test::lane_array(
        hierarchy.level(0).mesh, masked.whole.nodes, components, Width,
        [&](std::int64_t unknown, int lane) { return is_free(unknown) ? f(unknown, lane) : 0.0; });
  }
  LaneArray random(int salt) const {
    return vector([&](std::int64_t unknown, int lane) { return test::noise(unknown, salt + lane) - 0.5; });
  }
  LaneArray apply(const LaneArray& b) {
    LaneArray x(b.size(), NAN);
    multigrid.apply(b.data(), x.data());
    return x;
  }
  LaneScalars<Width> dot(const LaneArray& x, const LaneArray& y) {
    auto result = multigrid.finest().dot(x.data(), y.data());
    sum_in_place(comm, result);
    return result;
  }
  std::vector<double> whole(const LaneArray& values, int lane) const {
    return test::whole_lane(comm, hierarchy.level(0).mesh, masked.whole.nodes, values, components, Width,
                            lane);
  }

  MPI_Comm comm;
  test::MaskedGrid<Dim> masked;
  std::vector<int> touching;
  LaneHierarchy<Dim> hierarchy;
  Physics physics;
  LaneMultigrid<typename Physics::Problem, Width> multigrid;
  std::array<bool, Width> positive{};
};

LaneCycle cycle_of(SolverCycle kind, int degree = 2) {
  LaneCycle cycle;
  cycle.kind = kind;
  cycle.degree = degree;
  return cycle;
}

template <class T>
class LaneMultigridTest : public testing::Test {};
TYPED_TEST_SUITE(LaneMultigridTest, test::AllPhysics);

TYPED_TEST(LaneMultigridTest, FixedCyclesAreSymmetricAndPositive) {
  for (const auto& mask : connected_masks<TypeParam::Dim>())
    for (const LaneCycle& cycle :
         {cycle_of(SolverCycle::v), cycle_of(SolverCycle::w), cycle_of(SolverCycle::v, 3)}) {
      SCOPED_TRACE(mask.name + " " + std::to_string(static_cast<int>(cycle.kind)));
      Multigrid<TypeParam, 4> m(PETSC_COMM_WORLD, odd_size<TypeParam::Dim>(), mask, cycle);
      EXPECT_GE(m.hierarchy.count(), 3);
      const LaneArray a = m.random(1), b = m.random(11);
      const LaneArray ma = m.apply(a), mb = m.apply(b);
      const auto aa = m.dot(a, ma), bb = m.dot(b, mb), ab = m.dot(a, mb), ba = m.dot(b, ma);
      for (int lane = 0; lane < 4; ++lane) {
        EXPECT_TRUE(m.positive[lane]);
        EXPECT_GT(aa[lane], 0.0);
        EXPECT_GT(bb[lane], 0.0);
        EXPECT_NEAR(ab[lane], ba[lane], 1e-12 * std::sqrt(aa[lane] * bb[lane]));
      }
    }
}

/// M (2 a - 3 b) = 2 M a - 3 M b.
TYPED_TEST(LaneMultigridTest, FixedCyclesAreLinear) {
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w}) {
    const auto mask = connected_masks<TypeParam::Dim>()[1];
    Multigrid<TypeParam, 2> m(PETSC_COMM_WORLD, odd_size<TypeParam::Dim>(), mask, cycle_of(kind));
    const LaneArray a = m.random(1), b = m.random(11);
    LaneArray both = a, expected = m.apply(a);
    const LaneArray mb = m.apply(b);
    for (std::size_t i = 0; i < a.size(); ++i) {
      both[i] = 2.0 * a[i] - 3.0 * b[i];
      expected[i] = 2.0 * expected[i] - 3.0 * mb[i];
    }
    EXPECT_LT(test::relative_difference(m.apply(both), expected), 1e-12);
  }
}

/// The whole matrix M, for stiffness over nine decades.
TEST(LaneMultigridMatrixTest, IsSymmetricAndPositiveDefinite) {
  if (size_of(PETSC_COMM_WORLD) > 1) GTEST_SKIP() << "one rank sees the whole matrix";
  using Physics = test::ElasticPhysics<2>;
  for (const LaneCycle& cycle : {cycle_of(SolverCycle::v, 1), cycle_of(SolverCycle::v, 2)}) {
    Multigrid<Physics, 8> m(PETSC_COMM_WORLD, {26, 24}, connected_masks<2>()[0], cycle,
                            [](std::int64_t element, int) { return test::wild_factor(element, 0); });
    ASSERT_EQ(m.hierarchy.count(), 2);
    std::vector<std::int64_t> unknowns;
    for (std::int64_t i = 0; i < m.masked.whole.nodes.count() * 2; ++i)
      if (m.is_free(i)) unknowns.push_back(i);
    const int size = static_cast<int>(unknowns.size());
    std::vector<double> matrix(static_cast<std::size_t>(size) * size);
    for (int first = 0; first < size; first += 8) {
      const LaneArray columns = m.apply(m.vector([&](std::int64_t unknown, int lane) {
        return first + lane < size && unknown == unknowns[first + lane] ? 1.0 : 0.0;
      }));
      // All nodes are in the mesh: they have the same numbers in both.
      for (int lane = 0; lane < std::min(8, size - first); ++lane)
        for (int i = 0; i < size; ++i)
          matrix[static_cast<std::size_t>(first + lane) * size + i] = columns[unknowns[i] * 8 + lane];
    }
    const auto entry = [&](int i, int j) -> double& {
      return matrix[static_cast<std::size_t>(i) * size + j];
    };
    std::vector<double> scale;
    for (int i = 0; i < size; ++i) {
      EXPECT_GT(entry(i, i), 0.0);
      scale.push_back(1.0 / std::sqrt(entry(i, i)));
    }
    double asymmetry = 0.0;
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) {
        entry(i, j) *= scale[i] * scale[j];
        if (j < i) asymmetry = std::max(asymmetry, std::abs(entry(i, j) - entry(j, i)));
      }
    EXPECT_LT(asymmetry, 1e-7);  // nine of sixteen digits are in the stiffness
    EXPECT_TRUE(test::is_positive_definite(matrix, size));
  }
}

TYPED_TEST(LaneMultigridTest, DoesNotDependOnTheRanks) {
  constexpr int Dim = TypeParam::Dim;
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w, SolverCycle::k})
    for (const auto& size : {odd_size<Dim>(), large_size<Dim>()}) {
      const auto mask = connected_masks<Dim>()[size == large_size<Dim>() ? 0 : 1];
      Multigrid<TypeParam, 2> together(PETSC_COMM_WORLD, size, mask, cycle_of(kind));
      Multigrid<TypeParam, 2> alone(PETSC_COMM_SELF, size, mask, cycle_of(kind));
      const LaneArray x = together.apply(together.random(1)), expected = alone.apply(alone.random(1));
      for (int lane = 0; lane < 2; ++lane)
        EXPECT_LT(test::relative_difference(together.whole(x, lane), alone.whole(expected, lane)), 1e-10)
            << static_cast<int>(kind) << mask.name;
    }
}

TYPED_TEST(LaneMultigridTest, LanesCanBeSelected) {
  constexpr int Dim = TypeParam::Dim;
  const auto mask = connected_masks<Dim>()[1];
  const LaneCycle cycle = cycle_of(SolverCycle::k);
  Multigrid<TypeParam, 8> wide(PETSC_COMM_WORLD, odd_size<Dim>(), mask, cycle);
  LaneMultigrid<typename TypeParam::Problem, 2> narrow(wide.hierarchy, wide.physics.problem, cycle);
  const std::vector<int> lanes = {5, 2};
  narrow.template select<8>(wide.multigrid, lanes);
  const LaneArray b = wide.random(1), x = wide.apply(b);
  LaneArray narrow_b, expected, narrow_x(x.size() / 4);
  select_lanes(b, 8, lanes, narrow_b, 2);
  select_lanes(x, 8, lanes, expected, 2);
  narrow.apply(narrow_b.data(), narrow_x.data());
  EXPECT_LT(test::relative_difference(narrow_x, expected), 1e-10);
}

/// Held unknowns stay where they are, whatever pulls at them.
TYPED_TEST(LaneMultigridTest, HeldUnknownsStay) {
  constexpr int Dim = TypeParam::Dim;
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w, SolverCycle::k}) {
    Multigrid<TypeParam, 2> m(PETSC_COMM_WORLD, odd_size<Dim>(), connected_masks<Dim>()[0], cycle_of(kind));
    const LaneArray x = m.apply(m.random(1));
    for (const std::int64_t unknown : m.hierarchy.level(0).fixed)
      for (int lane = 0; lane < 2; ++lane) EXPECT_EQ(x[unknown * 2 + lane], 0.0);
  }
}

TYPED_TEST(LaneMultigridTest, SaysWhichLanesAreNotPositiveDefinite) {
  constexpr int Dim = TypeParam::Dim;
  constexpr bool own_operators = TypeParam::Problem::own_operators;
  Multigrid<TypeParam, 4> m(
      PETSC_COMM_WORLD, odd_size<Dim>(), connected_masks<Dim>()[0], cycle_of(SolverCycle::v),
      [](std::int64_t, int entry) { return entry == (own_operators ? 2 : 0) ? -1.0 : 1.0; });
  // Where lanes share the operator, the first speaks for all.
  for (int lane = 0; lane < (own_operators ? 4 : 1); ++lane)
    EXPECT_EQ(m.positive[lane], own_operators && lane != 2) << lane;
}

}  // namespace
}  // namespace fabseq
