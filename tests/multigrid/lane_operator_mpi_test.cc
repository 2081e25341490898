// SPDX-License-Identifier: MIT
/// A level's operator, residual and smoother on several ranks against sums over the elements of the whole
/// grid.
#include "multigrid/lane_operator.h"
#include "support/lane_physics.h"
#include "support/masked_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace fabseq {
namespace {

constexpr int width = 4;

template <int Dim>
Index<Dim> size() {
  if constexpr (Dim == 2)
    return {9, 8};
  else
    return {5, 4, 3};
}

/// A level with its operator, and plain sums over the same elements.
template <class Physics>
struct Level {
  static constexpr int Dim = Physics::Dim;
  static constexpr int components = Physics::components;
  using Operator = LaneOperator<typename Physics::Problem, width>;

  explicit Level(const test::Mask<Dim>& mask)
      : masked(PETSC_COMM_WORLD, size<Dim>(), mask, components, test::mixed_supports<Dim>()),
        touching(masked.whole.touching_elements()),
        hierarchy(masked.grid, masked.domain),
        matrix(hierarchy.level(0), physics.problem) {
    matrix.coefficients() = test::coefficient_array(hierarchy.level(0).mesh, masked.grid.all_elements(),
                                                    Operator::Kernel::stride, Physics::coefficient);
    matrix.set_up();
  }

  bool is_free(std::int64_t unknown) const {
    return touching[unknown / components] > 0 &&
           !test::mixed_supports<Dim>()(masked.whole.nodes.index(unknown / components),
                                        static_cast<int>(unknown % components));
  }
  /// Random values of the whole grid, zero where nothing is free.
  std::vector<double> random(int salt) const {
    std::vector<double> result;
    for (std::int64_t i = 0; i < masked.whole.nodes.count() * components; ++i)
      result.push_back(is_free(i) ? test::noise(i, salt) - 0.5 : 0.0);
    return result;
  }
  LaneArray on_mesh(const std::vector<std::vector<double>>& lanes) const {
    return test::lane_array(hierarchy.level(0).mesh, masked.whole.nodes, components, width,
                            [&](std::int64_t unknown, int lane) { return lanes[lane][unknown]; });
  }
  std::vector<double> whole(const LaneArray& values, int lane) const {
    return test::whole_lane(PETSC_COMM_WORLD, hierarchy.level(0).mesh, masked.whole.nodes, values, components,
                            width, lane);
  }
  /// K x, zero where nothing is free.
  test::PlainProduct product(const std::vector<double>& x, int lane) const {
    auto result = test::multiply(
        masked.whole, components, [&](std::int64_t element) { return physics.element_matrix(element, lane); },
        x);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!is_free(static_cast<std::int64_t>(i))) result.value[i] = 0.0;
    return result;
  }
  /// Relative to the terms that are summed up at each node.
  double error(const std::vector<double>& actual, const test::PlainProduct& expected) const {
    double worst = 0.0;
    for (std::size_t i = 0; i < actual.size(); ++i) {
      const double difference = std::abs(actual[i] - expected.value[i]);
      if (difference > 0.0) worst = std::max(worst, difference / expected.scale[i / components]);
    }
    return worst;
  }

  test::MaskedGrid<Dim> masked;
  std::vector<int> touching;
  LaneHierarchy<Dim> hierarchy;
  Physics physics;
  Operator matrix;
};

template <class Physics>
std::vector<std::vector<double>> random_lanes(const Level<Physics>& level, int salt) {
  std::vector<std::vector<double>> result;
  for (int lane = 0; lane < width; ++lane) result.push_back(level.random(salt + lane));
  return result;
}

template <class T>
class LaneOperatorTest : public testing::Test {};
TYPED_TEST_SUITE(LaneOperatorTest, test::AllPhysics);

TYPED_TEST(LaneOperatorTest, AppliesTheOperatorAndItsEnergy) {
  for (const auto& mask : test::masks<TypeParam::Dim>()) {
    SCOPED_TRACE(mask.name);
    Level<TypeParam> level(mask);
    const auto lanes = random_lanes(level, 1);
    const LaneArray x = level.on_mesh(lanes);
    LaneArray y(x.size(), NAN);
    auto energy = level.matrix.apply(x.data(), y.data());
    sum_in_place(PETSC_COMM_WORLD, energy);
    for (int lane = 0; lane < width; ++lane) {
      const auto expected = level.product(lanes[lane], lane);
      EXPECT_LT(level.error(level.whole(y, lane), expected), 3e-15);
      double product = 0.0;
      for (std::size_t i = 0; i < expected.value.size(); ++i) product += lanes[lane][i] * expected.value[i];
      EXPECT_NEAR(energy[lane], product, 1e-13 * std::abs(product));
    }
  }
}

TYPED_TEST(LaneOperatorTest, DotCountsEveryNodeOnce) {
  for (const auto& mask : test::masks<TypeParam::Dim>()) {
    Level<TypeParam> level(mask);
    const auto x = random_lanes(level, 1), y = random_lanes(level, 5);
    auto dot = level.matrix.dot(level.on_mesh(x).data(), level.on_mesh(y).data());
    sum_in_place(PETSC_COMM_WORLD, dot);
    for (int lane = 0; lane < width; ++lane) {
      double expected = 0.0;
      for (std::size_t i = 0; i < x[lane].size(); ++i) expected += x[lane][i] * y[lane][i];
      EXPECT_NEAR(dot[lane], expected, 1e-12) << mask.name;
    }
  }
}

/// Parts of shared nodes add up.
TYPED_TEST(LaneOperatorTest, ResidualPartsAddUp) {
  constexpr int components = TypeParam::components;
  for (const auto& mask : test::masks<TypeParam::Dim>()) {
    SCOPED_TRACE(mask.name);
    Level<TypeParam> level(mask);
    const auto x = random_lanes(level, 1), b = random_lanes(level, 5);
    const LaneArray mesh_x = level.on_mesh(x), mesh_b = level.on_mesh(b);
    LaneArray residual(mesh_x.size(), NAN);
    level.matrix.residual_part(mesh_b.data(), mesh_x.data(), residual.data());
    sum_over_holders(level.hierarchy.level(0), residual.data(), components * width);
    for (int lane = 0; lane < width; ++lane) {
      auto expected = level.product(x[lane], lane);
      for (std::size_t i = 0; i < x[lane].size(); ++i) {
        expected.value[i] = b[lane][i] - expected.value[i];
        if (i % components == 0) expected.scale[i / components] += 1.0;
      }
      EXPECT_LT(level.error(level.whole(residual, lane), expected), 3e-15);
    }
  }
}

/// x + D^-1 b of the level's own scaling.
template <class Physics>
std::vector<std::vector<double>> scaled(const Level<Physics>& level,
                                        const NodeScaling<typename Physics::Problem, width>& scaling,
                                        const std::vector<std::vector<double>>& b) {
  constexpr int block = Physics::components * width;
  LaneArray values = level.on_mesh(b);
  for (std::size_t node = 0; node < values.size() / block; ++node) {
    std::array<Lanes<width>, Physics::components> of_node;
    for (int a = 0; a < Physics::components; ++a)
      of_node[a] = Lanes<width>::load(&values[node * block + a * width]);
    of_node = scaling.apply(static_cast<std::int64_t>(node), of_node);
    for (int a = 0; a < Physics::components; ++a) of_node[a].store(&values[node * block + a * width]);
  }
  std::vector<std::vector<double>> result;
  for (int lane = 0; lane < width; ++lane) result.push_back(level.whole(values, lane));
  return result;
}

/// After k steps the residual is T_k((c - A) / r) / T_k(c / r) times the first one, with A = K D^-1, for
/// eigenvalues from c - r to c + r: the polynomial itself, by its three-term recursion.
TYPED_TEST(LaneOperatorTest, SmoothsWithChebyshevPolynomials) {
  using Vectors = std::vector<std::vector<double>>;
  for (const int which : {0, 1, 3}) {
    const auto mask = test::masks<TypeParam::Dim>()[which];
    SCOPED_TRACE(mask.name);
    Level<TypeParam> level(mask);
    NodeScaling<typename TypeParam::Problem, width> scaling;
    scaling.set_up(level.hierarchy.level(0), level.matrix.matrices(), level.matrix.coefficients().data());
    const double high = level.matrix.matrices().spectrum_bound, low = 0.15 * high;
    const double center = 0.5 * (high + low), radius = 0.5 * (high - low);
    const auto b = random_lanes(level, 5);
    const auto combine = [](double p, const Vectors& x, double q, const Vectors& y) {
      Vectors result = x;
      for (int lane = 0; lane < width; ++lane)
        for (std::size_t i = 0; i < x[lane].size(); ++i) result[lane][i] = p * x[lane][i] + q * y[lane][i];
      return result;
    };
    const auto multiply = [&](const Vectors& x) {
      Vectors result;
      for (int lane = 0; lane < width; ++lane) result.push_back(level.product(x[lane], lane).value);
      return result;
    };
    // (c - K D^-1) / r.
    const auto shifted = [&](const Vectors& x) {
      return combine(center / radius, x, -1.0 / radius, multiply(scaled(level, scaling, x)));
    };
    for (const bool from_zero : {true, false}) {
      const auto start = from_zero ? combine(0.0, b, 0.0, b) : random_lanes(level, 9);
      const auto first = combine(1.0, b, -1.0, multiply(start));
      Vectors previous = first, current = shifted(first);
      double previous_value = 1.0, value = center / radius;
      for (int degree = 1; degree <= 4; ++degree) {
        LaneArray x = level.on_mesh(start), step(x.size(), NAN);
        if (from_zero) std::fill(x.begin(), x.end(), NAN);
        level.matrix.smooth(level.on_mesh(b).data(), x.data(), step.data(), degree, from_zero);
        Vectors smoothed;
        for (int lane = 0; lane < width; ++lane) smoothed.push_back(level.whole(x, lane));
        const auto residual = combine(1.0, b, -1.0, multiply(smoothed));
        const auto expected = combine(1.0 / value, current, 0.0, current);
        for (int lane = 0; lane < width; ++lane)
          EXPECT_LT(test::relative_difference(residual[lane], expected[lane]), 1e-11)
              << degree << (from_zero ? " from zero" : "");
        const auto next = combine(2.0, shifted(current), -1.0, previous);
        const double next_value = 2.0 * center / radius * value - previous_value;
        previous = std::exchange(current, next);
        previous_value = std::exchange(value, next_value);
      }
    }
  }
}

TYPED_TEST(LaneOperatorTest, LanesCanBeSelected) {
  Level<TypeParam> level(test::masks<TypeParam::Dim>()[1]);
  LaneOperator<typename TypeParam::Problem, 2> narrow(level.hierarchy.level(0), level.physics.problem);
  const std::vector<int> chosen = {3, 1};
  narrow.template select<width>(level.matrix, chosen);
  const auto lanes = random_lanes(level, 1);
  const LaneArray x = level.on_mesh(lanes);
  LaneArray y(x.size()), narrow_x, expected, narrow_y(x.size() / 2);
  (void)level.matrix.apply(x.data(), y.data());
  select_lanes(x, width, chosen, narrow_x, 2);
  select_lanes(y, width, chosen, expected, 2);
  (void)narrow.apply(narrow_x.data(), narrow_y.data());
  EXPECT_LT(test::relative_difference(narrow_y, expected), 1e-14);
}

}  // namespace
}  // namespace fabseq
