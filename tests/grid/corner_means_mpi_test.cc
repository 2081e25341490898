// SPDX-License-Identifier: MIT
/// Means over the corners of elements: of a linear field, its values at their centres.
#include "fabseq/grid/corner_means.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <class T>
class CornerMeansTest : public testing::Test {};
TYPED_TEST_SUITE(CornerMeansTest, test::Dimensions);

TYPED_TEST(CornerMeansTest, OfALinearFieldAreItsValuesAtTheCentres) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  const Grid<Dim>& grid = on_grid.grid;
  const auto linear = [](const Point<Dim>& x) {
    double value = 0.5;
    for (int axis = 0; axis < Dim; ++axis) value += (axis + 1.0) * x[axis];
    return value;
  };
  std::vector<double> field;
  grid.owned_nodes().for_each(
      [&](const Index<Dim>& node, std::int64_t) { field.push_back(linear(grid.node_position(node))); });
  const auto means = corner_means(grid, on_grid.part.first_corners(), field);
  const std::vector<int>& elements = on_grid.part.elements();
  ASSERT_EQ(means.size(), elements.size());
  for (std::size_t e = 0; e < elements.size(); ++e)
    EXPECT_NEAR(means[e], linear(grid.element_center(grid.owned_elements().index(elements[e]))), 1e-12);
}

}  // namespace
}  // namespace fabseq
