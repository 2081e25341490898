// SPDX-License-Identifier: MIT
/// Inverse node blocks against blocks of dense matrices, inverted by elimination.
#include "multigrid/node_scaling.h"
#include "support/lane_physics.h"
#include "support/masked_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace fabseq {
namespace {

template <int Dim>
Index<Dim> size() {
  if constexpr (Dim == 2)
    return {9, 7};
  else
    return {5, 4, 5};
}

/// Inverse of a symmetric positive definite matrix without the `held` rows, which come out 0.
std::vector<double> inverse_without(std::vector<double> matrix, const std::vector<bool>& held) {
  const int size = static_cast<int>(held.size());
  std::vector<double> inverse(matrix.size(), 0.0);
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j)
      if (held[i] || held[j]) matrix[i * size + j] = i == j ? 1.0 : 0.0;
    inverse[i * size + i] = 1.0;
  }
  for (int pivot = 0; pivot < size; ++pivot)
    for (int row = 0; row < size; ++row) {
      const double factor = matrix[row * size + pivot] / matrix[pivot * size + pivot];
      for (int j = 0; row != pivot && j < size; ++j) {
        matrix[row * size + j] -= factor * matrix[pivot * size + j];
        inverse[row * size + j] -= factor * inverse[pivot * size + j];
      }
    }
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j)
      inverse[i * size + j] = held[i] || held[j] ? 0.0 : inverse[i * size + j] / matrix[i * size + i];
  return inverse;
}

template <class Physics, int Width>
struct Scaled {
  static constexpr int Dim = Physics::Dim;
  static constexpr int components = Physics::components;

  explicit Scaled(const test::Mask<Dim>& mask)
      : masked(PETSC_COMM_WORLD, size<Dim>(), mask, components, test::mixed_supports<Dim>()),
        hierarchy(masked.grid, masked.domain),
        coefficients(test::coefficient_array(level().mesh, masked.grid.all_elements(),
                                             Physics::Problem::template Kernel<Width>::stride,
                                             Physics::coefficient)) {
    scaling.set_up(level(), physics.matrices, coefficients.data());
  }
  LaneLevel<Dim>& level() { return hierarchy.level(0); }
  /// Block of every node of the grid in a lane.
  std::vector<std::vector<double>> blocks(int lane) const {
    const auto& box = masked.whole;
    std::vector<std::vector<double>> result(box.nodes.count(), std::vector<double>(components * components));
    box.for_each_active([&](const Index<Dim>& index, std::int64_t element) {
      const auto matrix = physics.element_matrix(element, lane);
      for (int i = 0; i < components * corner_count<Dim>; ++i)
        for (int b = 0; b < components; ++b) {
          const int corner = i / components;
          result[box.nodes.offset(box.corner_node(index, corner))][i % components * components + b] +=
              matrix[i * components * corner_count<Dim> + corner * components + b];
        }
    });
    return result;
  }

  test::MaskedGrid<Dim> masked;
  LaneHierarchy<Dim> hierarchy;
  Physics physics;
  LaneArray coefficients;
  NodeScaling<typename Physics::Problem, Width> scaling;
};

/// In single precision: of the largest entry.
template <class Physics, int Width>
void expect_inverse_blocks(const test::Mask<Physics::Dim>& mask,
                           const NodeScaling<typename Physics::Problem, Width>* other = nullptr,
                           const std::vector<int>& lanes = {}) {
  constexpr int components = Physics::components;
  Scaled<Physics, Width> scaled(mask);
  const auto& scaling = other != nullptr ? *other : scaled.scaling;
  for (int lane = 0; lane < Width; ++lane) {
    const auto blocks =
        scaled.blocks(lanes.empty() ? lane : lanes[std::min<std::size_t>(lane, lanes.size() - 1)]);
    test::for_each_node(scaled.level().mesh, [&](const Index<Physics::Dim>& node, std::int64_t number) {
      std::vector<bool> held;
      for (int a = 0; a < components; ++a) held.push_back(test::mixed_supports<Physics::Dim>()(node, a));
      const auto expected = inverse_without(blocks[scaled.masked.whole.nodes.offset(node)], held);
      for (int b = 0; b < components; ++b) {
        typename NodeScaling<typename Physics::Problem, Width>::Values unit;
        for (int a = 0; a < components; ++a) unit[a] = Lanes<Width>::broadcast(a == b ? 1.0 : 0.0);
        const auto column = scaling.apply(number, unit);
        for (int a = 0; a < components; ++a) {
          EXPECT_NEAR(column[a][lane], expected[a * components + b], 1e-6 * test::largest(expected))
              << mask.name << " " << to_text<Physics::Dim>(node);
          EXPECT_TRUE((!held[a] && !held[b]) || column[a][lane] == 0.0);
        }
      }
    });
  }
}

template <class T>
class NodeScalingTest : public testing::Test {};
TYPED_TEST_SUITE(NodeScalingTest, test::AllPhysics);

TYPED_TEST(NodeScalingTest, IsTheInverseOfTheNodeBlocks) {
  for (const auto& mask : test::masks<TypeParam::Dim>()) {
    expect_inverse_blocks<TypeParam, 1>(mask);
    expect_inverse_blocks<TypeParam, 8>(mask);
  }
}

/// With one component, nodes that follow each other are scaled as one by one.
template <int Width>
void expect_several_as_one_by_one() {
  using Physics = test::HeatPhysics<3>;
  for (const auto& mask : test::masks<3>()) {
    Scaled<Physics, Width> scaled(mask);
    const std::int64_t pairs = scaled.level().mesh.nodes() / 2;
    for (std::int64_t node = 0; node < 2 * pairs; node += 2) {
      std::array<double, 2 * Width> values;
      for (int i = 0; i < 2 * Width; ++i) values[i] = test::noise(node + i, 3);
      const auto both = scaled.scaling.apply(node, std::array{Lanes<2 * Width>::load(values.data())})[0];
      for (int i = 0; i < 2 * Width; ++i) {
        const auto one = std::array{Lanes<Width>::load(values.data() + i / Width * Width)};
        EXPECT_EQ(both[i], scaled.scaling.apply(node + i / Width, one)[0][i % Width]);
      }
    }
  }
}

TEST(NodeScalingOfHeatTest, ScalesSeveralNodesAtOnce) {
  expect_several_as_one_by_one<1>();
  expect_several_as_one_by_one<2>();
}

/// Entry (a, b) is entry (b, a) in every bit, and whatever is scaled keeps its sign: else the smoother is no
/// preconditioner of conjugate gradients.
TYPED_TEST(NodeScalingTest, IsExactlySymmetricAndPositive) {
  constexpr int components = TypeParam::components;
  Scaled<TypeParam, 4> scaled(test::masks<TypeParam::Dim>()[1]);
  for (std::int64_t node = 0; node < scaled.level().mesh.nodes(); ++node) {
    std::array<std::array<Lanes<4>, components>, components> columns;
    std::array<Lanes<4>, components> some;
    for (int b = 0; b < components; ++b) {
      for (int a = 0; a < components; ++a) some[a] = Lanes<4>::broadcast(a == b ? 1.0 : 0.0);
      columns[b] = scaled.scaling.apply(node, some);
    }
    for (int a = 0; a < components; ++a) some[a] = Lanes<4>::broadcast(test::noise(node, a) - 0.5);
    const auto image = scaled.scaling.apply(node, some);
    for (int lane = 0; lane < 4; ++lane) {
      double product = 0.0;
      for (int a = 0; a < components; ++a) {
        product += some[a][lane] * image[a][lane];
        for (int b = 0; b < a; ++b) EXPECT_EQ(columns[a][b][lane], columns[b][a][lane]);
      }
      EXPECT_GE(product, 0.0);
    }
  }
}

TYPED_TEST(NodeScalingTest, LanesCanBeSelected) {
  const auto mask = test::masks<TypeParam::Dim>()[1];
  Scaled<TypeParam, 8> wide(mask);
  for (const std::vector<int>& lanes : {std::vector<int>{6, 1, 3, 5}, std::vector<int>{2}}) {
    NodeScaling<typename TypeParam::Problem, 4> narrow;
    narrow.template select<8>(wide.scaling, lanes);
    std::vector<int> expected = lanes;
    expected.resize(4, lanes[0]);
    expect_inverse_blocks<TypeParam, 4>(mask, &narrow, expected);
  }
}

}  // namespace
}  // namespace fabseq
