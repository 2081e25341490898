// SPDX-License-Identifier: MIT
/// The lane multigrid as a linear operator: symmetric, positive definite, the same on any number of ranks.
#include "multigrid/lane_multigrid.h"
#include "support/multigrid_case.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

/// Of nearly all cases: each width takes as long again to compile.
constexpr int width = 4;

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
template <class T>
class LaneMultigridTest : public testing::Test {};
TYPED_TEST_SUITE(LaneMultigridTest, test::AllPhysics);

TYPED_TEST(LaneMultigridTest, FixedCyclesAreSymmetricAndPositive) {
  for (const auto& mask : test::connected_masks<TypeParam::Dim>())
    for (const LaneCycle& cycle : {test::cycle_of(SolverCycle::v), test::cycle_of(SolverCycle::w),
                                   test::cycle_of(SolverCycle::v, 3)}) {
      SCOPED_TRACE(mask.name + " " + std::to_string(static_cast<int>(cycle.kind)));
      test::MultigridCase<TypeParam, width> m(PETSC_COMM_WORLD, odd_size<TypeParam::Dim>(), mask, cycle);
      EXPECT_GE(m.hierarchy.count(), 3);
      for (const bool positive : m.positive) EXPECT_TRUE(positive);
      m.expect_symmetric_and_positive(1e-12);
    }
}

/// M (2 a - 3 b) = 2 M a - 3 M b.
TYPED_TEST(LaneMultigridTest, FixedCyclesAreLinear) {
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w}) {
    const auto mask = test::connected_masks<TypeParam::Dim>()[1];
    test::MultigridCase<TypeParam, width> m(PETSC_COMM_WORLD, odd_size<TypeParam::Dim>(), mask,
                                            test::cycle_of(kind));
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
  if (size_of(PETSC_COMM_WORLD) > 1) GTEST_SKIP() << "ranks: one rank sees the whole matrix";
  using Physics = test::ElasticPhysics<2>;
  for (const LaneCycle& cycle : {test::cycle_of(SolverCycle::v, 1), test::cycle_of(SolverCycle::v, 2)}) {
    test::MultigridCase<Physics, width> m(
        PETSC_COMM_WORLD, {26, 24}, test::connected_masks<2>()[0], cycle,
        [](std::int64_t element, int) { return test::wild_factor(element, 0); });
    ASSERT_EQ(m.hierarchy.count(), 2);
    std::vector<std::int64_t> unknowns;
    for (std::int64_t i = 0; i < m.masked.whole.nodes.count() * 2; ++i)
      if (m.is_free(i)) unknowns.push_back(i);
    const int size = static_cast<int>(unknowns.size());
    std::vector<double> matrix(static_cast<std::size_t>(size) * size);
    for (int first = 0; first < size; first += width) {
      const LaneArray columns = m.apply(m.vector([&](std::int64_t unknown, int lane) {
        return first + lane < size && unknown == unknowns[first + lane] ? 1.0 : 0.0;
      }));
      // All nodes are in the mesh: they have the same numbers in both.
      for (int lane = 0; lane < std::min(width, size - first); ++lane)
        for (int i = 0; i < size; ++i)
          matrix[static_cast<std::size_t>(first + lane) * size + i] = columns[unknowns[i] * width + lane];
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

/// In single precision it is the same to six digits.
TYPED_TEST(LaneMultigridTest, SinglePrecisionIsAlmostTheSame) {
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w, SolverCycle::k}) {
    const auto mask = test::connected_masks<TypeParam::Dim>()[1];
    test::MultigridCase<TypeParam, width> m(PETSC_COMM_WORLD, odd_size<TypeParam::Dim>(), mask,
                                            test::cycle_of(kind));
    LaneMultigrid<typename TypeParam::Problem, width, float> rounded(m.hierarchy, m.physics.problem,
                                                                     test::cycle_of(kind));
    const LaneArray& coefficients = m.multigrid.finest().coefficients();
    rounded.finest().coefficients().assign(coefficients.begin(), coefficients.end());
    EXPECT_EQ(rounded.set_up(), m.positive);
    const LaneArray b = m.random(1), expected = m.apply(b);
    const LaneValues<float> rounded_b(b.begin(), b.end());
    LaneValues<float> x(b.size());
    rounded.apply(rounded_b.data(), x.data());
    const LaneArray widened(x.begin(), x.end());
    for (int lane = 0; lane < width; ++lane)
      EXPECT_LT(test::relative_difference(m.whole(widened, lane), m.whole(expected, lane)), 1e-4)
          << static_cast<int>(kind);
  }
}

TYPED_TEST(LaneMultigridTest, DoesNotDependOnTheRanks) {
  constexpr int Dim = TypeParam::Dim;
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w, SolverCycle::k})
    for (const auto& size : {odd_size<Dim>(), large_size<Dim>()}) {
      const auto mask = test::connected_masks<Dim>()[size == large_size<Dim>() ? 0 : 1];
      test::MultigridCase<TypeParam, width> together(PETSC_COMM_WORLD, size, mask, test::cycle_of(kind));
      test::MultigridCase<TypeParam, width> alone(PETSC_COMM_SELF, size, mask, test::cycle_of(kind));
      const LaneArray x = together.apply(together.random(1)), expected = alone.apply(alone.random(1));
      for (int lane = 0; lane < width; ++lane)
        EXPECT_LT(test::relative_difference(together.whole(x, lane), alone.whole(expected, lane)), 1e-10)
            << static_cast<int>(kind) << mask.name;
    }
}

TYPED_TEST(LaneMultigridTest, LanesCanBeSelected) {
  constexpr int Dim = TypeParam::Dim;
  const auto mask = test::connected_masks<Dim>()[1];
  const LaneCycle cycle = test::cycle_of(SolverCycle::k);
  test::MultigridCase<TypeParam, width> wide(PETSC_COMM_WORLD, odd_size<Dim>(), mask, cycle);
  LaneMultigrid<typename TypeParam::Problem, 2> narrow(wide.hierarchy, wide.physics.problem, cycle);
  const std::vector<int> lanes = {3, 1};
  narrow.template select<width>(wide.multigrid, lanes);
  const LaneArray b = wide.random(1), x = wide.apply(b);
  LaneArray narrow_b, expected, narrow_x(x.size() / 2);
  select_lanes(b, width, lanes, narrow_b, 2);
  select_lanes(x, width, lanes, expected, 2);
  narrow.apply(narrow_b.data(), narrow_x.data());
  EXPECT_LT(test::relative_difference(narrow_x, expected), 1e-10);
}

/// Held unknowns stay where they are, whatever pulls at them.
TYPED_TEST(LaneMultigridTest, HeldUnknownsStay) {
  constexpr int Dim = TypeParam::Dim;
  for (const SolverCycle kind : {SolverCycle::v, SolverCycle::w, SolverCycle::k}) {
    test::MultigridCase<TypeParam, width> m(PETSC_COMM_WORLD, odd_size<Dim>(),
                                            test::connected_masks<Dim>()[0], test::cycle_of(kind));
    const LaneArray x = m.apply(m.random(1));
    for (const std::int64_t unknown : m.hierarchy.level(0).fixed)
      for (int lane = 0; lane < width; ++lane) EXPECT_EQ(x[unknown * width + lane], 0.0);
  }
}

TYPED_TEST(LaneMultigridTest, SaysWhichLanesAreNotPositiveDefinite) {
  constexpr int Dim = TypeParam::Dim;
  constexpr bool own_operators = TypeParam::Problem::own_operators;
  test::MultigridCase<TypeParam, width> m(
      PETSC_COMM_WORLD, odd_size<Dim>(), test::connected_masks<Dim>()[0], test::cycle_of(SolverCycle::v),
      [](std::int64_t, int entry) { return entry == (own_operators ? 2 : 0) ? -1.0 : 1.0; });
  // Where lanes share the operator, the first speaks for all.
  for (int lane = 0; lane < (own_operators ? width : 1); ++lane)
    EXPECT_EQ(m.positive[lane], own_operators && lane != 2) << lane;
}

}  // namespace
}  // namespace fabseq
