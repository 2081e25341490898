// SPDX-License-Identifier: MIT
/// Interpolation between lane meshes against the hat functions.
#include "kernels/lane_transfer.h"

#include "support/masked_box.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fabseq {
namespace {

/// A mesh, the coarser one around it, and how they are to be related.
template <int Dim>
struct TwoMeshes {
  /// `whole`: the coarse mesh is that of the whole grid.
  TwoMeshes(const test::MaskedBox<Dim>& box_, const Index<Dim>& factors_, bool whole)
      : box(box_),
        factors(factors_),
        fine(box.elements, box.active),
        coarse(coarse_mesh(whole)),
        transfer(fine, coarse, factors) {}

  LaneMesh<Dim> coarse_mesh(bool whole) const {
    IndexBox<Dim> around;
    for (int axis = 0; axis < Dim; ++axis) {
      const int end = box.elements.start[axis] + box.elements.size[axis];
      around.start[axis] = whole ? 0 : box.elements.start[axis] / factors[axis];
      around.size[axis] = (end + factors[axis] - 1) / factors[axis] - around.start[axis];
    }
    std::vector<char> active(around.count(), 0);
    box.for_each_active([&](Index<Dim> element, std::int64_t) {
      for (int axis = 0; axis < Dim; ++axis) element[axis] /= factors[axis];
      active[around.offset(element)] = 1;
    });
    return LaneMesh<Dim>(around, active);
  }
  /// f(fine node, its number, coarse node, its number, weight) for all entries of P.
  template <class Function>
  void for_each_entry(Function&& f) const {
    for_each_node(fine, [&](const Index<Dim>& node, std::int64_t number) {
      around(node).for_each([&](const Index<Dim>& at, std::int64_t) {
        double weight = 1.0;
        for (int axis = 0; axis < Dim; ++axis)
          weight *= std::max(0.0, 1.0 - std::abs(at[axis] - static_cast<double>(node[axis]) / factors[axis]));
        const bool is_there = coarse.node_box().contains(at) && coarse.node_number(at) >= 0;
        if (weight > 0.0 && is_there) f(node, number, at, coarse.node_number(at), weight);
      });
    });
  }
  /// Coarse nodes next to a fine one; hat functions of the others vanish there.
  IndexBox<Dim> around(const Index<Dim>& node) const {
    IndexBox<Dim> result;
    for (int axis = 0; axis < Dim; ++axis) {
      result.start[axis] = node[axis] / factors[axis] - 1;
      result.size[axis] = 3;
    }
    return result;
  }
  template <class Function>
  static void for_each_node(const LaneMesh<Dim>& mesh, Function&& f) {
    mesh.node_box().for_each([&](const Index<Dim>& node, std::int64_t) {
      if (mesh.node_number(node) >= 0) f(node, mesh.node_number(node));
    });
  }

  test::MaskedBox<Dim> box;
  Index<Dim> factors;
  LaneMesh<Dim> fine, coarse;
  LaneTransfer<Dim> transfer;
};

/// All masks and factors; starts that are no multiple of the factors only where the coarse mesh is whole.
template <int Dim>
std::vector<TwoMeshes<Dim>> all_pairs() {
  std::vector<TwoMeshes<Dim>> result;
  for (const auto& box : test::masked_boxes<Dim>())
    for (int halved = 0; halved < (1 << Dim); ++halved) {
      Index<Dim> factors;
      bool aligned = true;
      for (int axis = 0; axis < Dim; ++axis) {
        factors[axis] = ((halved >> axis) & 1) != 0 ? 2 : 1;
        aligned = aligned && box.elements.start[axis] % factors[axis] == 0;
      }
      result.emplace_back(box, factors, true);
      if (aligned) result.emplace_back(box, factors, false);
    }
  return result;
}

std::vector<double> random_values(std::int64_t count, int salt) {
  std::vector<double> result;
  for (std::int64_t i = 0; i < count; ++i) result.push_back(test::noise(i, salt) - 0.5);
  return result;
}

template <class T>
class LaneTransferTest : public testing::Test {};
TYPED_TEST_SUITE(LaneTransferTest, test::Dimensions);

/// Every node finds all it is interpolated from, so that weights add up to 1.
TYPED_TEST(LaneTransferTest, EveryNodeIsWhollyInterpolated) {
  for (const auto& pair : all_pairs<TypeParam::value>()) {
    std::vector<double> sums(pair.fine.nodes(), 0.0);
    pair.for_each_entry(
        [&](auto&, std::int64_t fine, auto&, std::int64_t, double weight) { sums[fine] += weight; });
    for (const double sum : sums) EXPECT_EQ(sum, 1.0) << pair.box.name;
    EXPECT_LE(pair.coarse.elements(), pair.fine.elements());
  }
}

template <int Dim, int Components, int Width>
void expect_hat_functions(const TwoMeshes<Dim>& pair) {
  constexpr int block = Components * Width;
  const auto coarse = random_values(pair.coarse.nodes() * block, 1);
  const auto fine = random_values(pair.fine.nodes() * block, 2);
  auto prolonged = fine, restricted = coarse;
  pair.transfer.template prolong_add<Components, Width>(coarse.data(), prolonged.data());
  pair.transfer.template restrict_add<Components, Width>(fine.data(), restricted.data());
  auto expected_fine = fine, expected_coarse = coarse;
  pair.for_each_entry([&](auto&, std::int64_t number, auto&, std::int64_t coarse_number, double weight) {
    for (int i = 0; i < block; ++i) {
      expected_fine[number * block + i] += weight * coarse[coarse_number * block + i];
      expected_coarse[coarse_number * block + i] += weight * fine[number * block + i];
    }
  });
  EXPECT_LE(test::relative_difference(prolonged, expected_fine), 1e-15) << pair.box.name;
  EXPECT_LE(test::relative_difference(restricted, expected_coarse), 3e-15) << pair.box.name;
}

TYPED_TEST(LaneTransferTest, AddsHatFunctionsAndTheirTranspose) {
  constexpr int Dim = TypeParam::value;
  for (const auto& pair : all_pairs<Dim>()) {
    expect_hat_functions<Dim, Dim, 8>(pair);
    expect_hat_functions<Dim, Dim, 1>(pair);
    expect_hat_functions<Dim, 1, 2>(pair);
  }
}

/// P c . f = c . P^T f.
TYPED_TEST(LaneTransferTest, RestrictionIsAdjointToProlongation) {
  constexpr int Dim = TypeParam::value;
  for (const auto& pair : all_pairs<Dim>()) {
    const auto coarse = random_values(pair.coarse.nodes() * Dim * 4, 1);
    const auto fine = random_values(pair.fine.nodes() * Dim * 4, 2);
    std::vector<double> prolonged(fine.size(), 0.0), restricted(coarse.size(), 0.0);
    pair.transfer.template prolong_add<Dim, 4>(coarse.data(), prolonged.data());
    pair.transfer.template restrict_add<Dim, 4>(fine.data(), restricted.data());
    for (int lane = 0; lane < 4; ++lane) {
      double left = 0.0, right = 0.0;
      for (std::size_t i = lane; i < fine.size(); i += 4) left += prolonged[i] * fine[i];
      for (std::size_t i = lane; i < coarse.size(); i += 4) right += restricted[i] * coarse[i];
      EXPECT_NEAR(left, right, 1e-13 * static_cast<double>(fine.size())) << pair.box.name;
    }
  }
}

TYPED_TEST(LaneTransferTest, ReproducesLinearFunctions) {
  constexpr int Dim = TypeParam::value;
  for (const auto& pair : all_pairs<Dim>()) {
    const auto linear = [&](const Index<Dim>& node, const Index<Dim>& step, int lane) {
      double value = 0.7 * lane;
      for (int axis = 0; axis < Dim; ++axis) value += (axis - 0.4 + lane) * node[axis] * step[axis];
      return value;
    };
    Index<Dim> ones;
    ones.fill(1);
    std::vector<double> coarse(pair.coarse.nodes() * 2), fine(pair.fine.nodes() * 2, 0.0);
    pair.for_each_node(pair.coarse, [&](const Index<Dim>& node, std::int64_t number) {
      for (int lane = 0; lane < 2; ++lane) coarse[number * 2 + lane] = linear(node, pair.factors, lane);
    });
    pair.transfer.template prolong_add<1, 2>(coarse.data(), fine.data());
    pair.for_each_node(pair.fine, [&](const Index<Dim>& node, std::int64_t number) {
      for (int lane = 0; lane < 2; ++lane)
        EXPECT_NEAR(fine[number * 2 + lane], linear(node, ones, lane), 1e-13) << pair.box.name;
    });
  }
}

}  // namespace
}  // namespace fabseq
