// SPDX-License-Identifier: MIT
/// Owned nodal fields and vectors on the lane mesh, there and back.
#include "multigrid/lane_layout.h"
#include "support/masked_grid.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <int Dim>
Index<Dim> size() {
  if constexpr (Dim == 2)
    return {9, 8};
  else
    return {5, 6, 3};
}
/// Of an unknown of the whole grid.
double value(std::int64_t unknown, int lane) { return test::noise(unknown, lane) - 0.5; }

template <int Dim>
struct Layout {
  explicit Layout(const test::Mask<Dim>& mask)
      : masked(PETSC_COMM_WORLD, size<Dim>(), mask, {Dim - 1, false}),
        hierarchy(masked.grid, masked.domain),
        layout(masked.grid, hierarchy.level(0), Dim) {}

  LaneVector owned(int lanes) const {
    LaneVector result(static_cast<int>(masked.grid.owned_nodes().count()), Dim, lanes);
    for (int lane = 0; lane < lanes; ++lane)
      result.set_lane(lane, test::node_field(masked.grid, Dim,
                                             [&](std::int64_t unknown) { return value(unknown, lane); }));
    return result;
  }
  test::MaskedGrid<Dim> masked;
  LaneHierarchy<Dim> hierarchy;
  LaneLayout<Dim> layout;
};

template <class T>
class LaneLayoutTest : public testing::Test {};
TYPED_TEST_SUITE(LaneLayoutTest, test::Dimensions);

TYPED_TEST(LaneLayoutTest, FillsTheMeshAndLeavesLanesBeyondZero) {
  constexpr int Dim = TypeParam::value;
  for (const auto& mask : test::masks<Dim>()) {
    const Layout<Dim> case_(mask);
    for (const int lanes : {1, 3, 8})
      for (const int width : {lanes, 8}) {
        LaneArray mesh(7, -1.0), expected;
        case_.layout.to_mesh(case_.owned(lanes), width, mesh);
        expected = test::lane_array(
            case_.hierarchy.level(0).mesh, case_.masked.whole.nodes, Dim, width,
            [&](std::int64_t unknown, int lane) { return lane < lanes ? value(unknown, lane) : 0.0; });
        EXPECT_EQ(mesh, expected) << mask.name << " " << lanes;
      }
  }
}

TYPED_TEST(LaneLayoutTest, GivesBackWhatTheMeshHas) {
  constexpr int Dim = TypeParam::value;
  for (const auto& mask : test::masks<Dim>()) {
    const Layout<Dim> case_(mask);
    const auto touching = case_.masked.whole.touching_elements();
    for (const int lanes : {1, 3, 8}) {
      LaneArray mesh;
      case_.layout.to_mesh(case_.owned(lanes), 8, mesh);
      LaneVector back(static_cast<int>(case_.masked.grid.owned_nodes().count()), Dim, lanes);
      std::fill(back.values.begin(), back.values.end(), 7.0);
      case_.layout.to_owned(mesh, 8, back);
      for (int lane = 0; lane < lanes; ++lane)
        EXPECT_EQ(back.lane(lane),
                  test::node_field(case_.masked.grid, Dim,
                                   [&](std::int64_t unknown) {
                                     return touching[unknown / Dim] > 0 ? value(unknown, lane) : 0.0;
                                   }))
            << mask.name;
    }
  }
}

}  // namespace
}  // namespace fabseq
