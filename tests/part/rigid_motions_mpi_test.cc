// SPDX-License-Identifier: MIT
/// Rigid motions and their fit (formulation 4.3).
#include "fabseq/part/rigid_motions.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <int Dim>
struct Case {
  Case() : on_grid(test::odd_domain<Dim>(), test::block<Dim>()) {}
  const Grid<Dim>& grid() const { return on_grid.grid; }
  template <class Wanted>
  std::vector<int> nodes(Wanted&& wanted) const {
    std::vector<int> result;
    grid().owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
      if (wanted(node)) result.push_back(static_cast<int>(offset));
    });
    return result;
  }
  std::vector<double> noise(int salt) const {
    return test::node_field(grid(), Dim, [&](std::int64_t i) { return test::noise(i, salt) - 0.4; });
  }
  /// Translation and rotation about some point.
  std::vector<double> motion() const {
    std::vector<double> result;
    grid().owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t) {
      const Point<Dim> x = grid().node_position(node);
      for (int a = 0; a < Dim; ++a) {
        double value = 0.3 - a;
        if (a == 0) value -= 0.7 * (x[1] - 3.0);
        if (a == 1) value += 0.7 * (x[0] + 1.0);
        if (Dim == 3 && a == 1) value -= 0.2 * x[Dim - 1];
        if (Dim == 3 && a == 2) value += 0.2 * x[1];
        result.push_back(value);
      }
    });
    return result;
  }

  test::PartOnGrid<Dim> on_grid;
};

template <class T>
class RigidMotionsTest : public testing::Test {};
TYPED_TEST_SUITE(RigidMotionsTest, test::Dimensions);

TYPED_TEST(RigidMotionsTest, MotionsAreFittedExactly) {
  constexpr int Dim = TypeParam::value;
  const Case<Dim> box;
  const RigidMotions<Dim> motions(box.grid(), box.nodes([](const auto& node) { return node[0] == 0; }));
  EXPECT_TRUE(motions.determined());
  std::vector<double> u = box.motion();
  motions.remove_fit(u);
  EXPECT_LT(test::largest(u), 1e-12);
}

/// What is left of any displacement has no fit, and what is left of any forces no resultants.
TYPED_TEST(RigidMotionsTest, ProjectionsAreTransposed) {
  constexpr int Dim = TypeParam::value;
  const Case<Dim> box;
  const RigidMotions<Dim> motions(box.grid(), box.nodes([](const auto& node) { return node[0] < 2; }));
  const std::vector<double> u = box.noise(1), b = box.noise(2);
  std::vector<double> rest = u, balanced = b;
  motions.remove_fit(rest);
  motions.balance(balanced);
  EXPECT_NEAR(test::dot(rest, b), test::dot(u, balanced), 1e-11);
  EXPECT_NEAR(test::dot(balanced, box.motion()), 0.0, 1e-11);
  std::vector<double> again = rest;
  motions.remove_fit(again);
  EXPECT_LT(test::relative_difference(again, rest), 1e-12);
}

TYPED_TEST(RigidMotionsTest, AFewNodesDetermineThem) {
  constexpr int Dim = TypeParam::value;
  const Case<Dim> box;
  const auto is = [](const Index<Dim>& node, const Index<Dim>& other) { return node == other; };
  const Index<Dim> origin{};
  Index<Dim> along_x{}, along_y{};
  along_x[0] = 2;
  along_y[1] = 1;
  const auto determined = [&](auto&& wanted) {
    return RigidMotions<Dim>(box.grid(), box.nodes(wanted)).determined();
  };
  EXPECT_FALSE(determined([](const auto&) { return false; }));
  EXPECT_FALSE(determined([&](const auto& node) { return is(node, origin); }));
  EXPECT_EQ(determined([&](const auto& node) { return is(node, origin) || is(node, along_x); }), Dim == 2);
  EXPECT_TRUE(determined(
      [&](const auto& node) { return is(node, origin) || is(node, along_x) || is(node, along_y); }));
}

}  // namespace
}  // namespace fabseq
