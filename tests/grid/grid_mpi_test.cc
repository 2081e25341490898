// SPDX-License-Identifier: MIT
/// The grid's boxes, numbers and exchanges against exact counts, with unequal spacings and odd sizes.
#include "fabseq/grid/grid.h"
#include "support/refusal.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace fabseq {
namespace {

const Domain<3> odd_box{{1.4, 0.9, 2.5}, {7, 3, 5}, 1.0};
const Domain<2> odd_plane{{3.5, 0.6}, {7, 3}, 0.25};

template <int Dim>
Domain<Dim> odd_domain() {
  if constexpr (Dim == 2)
    return odd_plane;
  else
    return odd_box;
}

/// Uneven on purpose, so that ranges are too.
template <int Dim>
std::vector<double> skewed(const IndexBox<Dim>& box) {
  std::vector<double> weights(static_cast<std::size_t>(box.count()));
  box.for_each([&](const Index<Dim>& element, std::int64_t offset) { weights[offset] = 1.0 + element[0]; });
  return weights;
}

template <class T>
class GridTest : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(GridTest, Dimensions);

TYPED_TEST(GridTest, EveryElementAndNodeHasOneOwner) {
  constexpr int Dim = TypeParam::value;
  const Grid<Dim> grid(PETSC_COMM_WORLD, odd_domain<Dim>(), skewed<Dim>);
  const std::vector<double> elements(static_cast<std::size_t>(grid.owned_elements().count()), 1.0);
  const std::vector<double> nodes(static_cast<std::size_t>(grid.owned_nodes().count()), 1.0);
  EXPECT_GT(elements.size(), 0u);
  for (const double count : test::whole_element_field<Dim>(grid, elements)) EXPECT_EQ(count, 1.0);
  for (const double count : test::whole_node_field<Dim>(grid, nodes)) EXPECT_EQ(count, 1.0);
  int ranks = 1;
  for (const int extent : grid.decomposition().processes) ranks *= extent;
  EXPECT_EQ(ranks, size_of(PETSC_COMM_WORLD));
}

TYPED_TEST(GridTest, ElementsHaveTheirNodesInTheGhostedBox) {
  constexpr int Dim = TypeParam::value;
  const Grid<Dim> grid(PETSC_COMM_WORLD, odd_domain<Dim>(), skewed<Dim>);
  grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t) {
    EXPECT_TRUE(grid.owned_nodes().contains(element));
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      Index<Dim> node = element;
      for (int axis = 0; axis < Dim; ++axis) node[axis] += (corner >> axis) & 1;
      EXPECT_TRUE(grid.ghosted_nodes().contains(node));
      EXPECT_EQ(grid.first_corner(element) + grid.corner_offsets()[corner],
                grid.ghosted_nodes().offset(node));
    }
  });
}

TYPED_TEST(GridTest, ElementNumbersRunRankAfterRank) {
  constexpr int Dim = TypeParam::value;
  const Grid<Dim> grid(PETSC_COMM_WORLD, odd_domain<Dim>(), skewed<Dim>);
  std::int64_t first = exclusive_sum(grid.comm(), grid.owned_elements().count());
  grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t offset) {
    EXPECT_EQ(grid.element_number(element), first + offset);
  });
  std::vector<std::int64_t> numbers;  // of elements of all ranks, known to each
  grid.all_elements().for_each(
      [&](const Index<Dim>& element, std::int64_t) { numbers.push_back(grid.element_number(element)); });
  std::sort(numbers.begin(), numbers.end());
  for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], static_cast<std::int64_t>(i));
}

TYPED_TEST(GridTest, GhostedValuesAreThoseOfTheOwners) {
  constexpr int Dim = TypeParam::value;
  const Grid<Dim> grid(PETSC_COMM_WORLD, odd_domain<Dim>(), skewed<Dim>);
  for (const int components : {1, 2, 3, 8}) {
    const auto value = [&](const Index<Dim>& node, int c) {
      return 100.0 * grid.all_nodes().offset(node) + c;
    };
    std::vector<double> owned(static_cast<std::size_t>(grid.owned_nodes().count() * components));
    std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count() * components), -1.0);
    grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
      for (int c = 0; c < components; ++c) owned[offset * components + c] = value(node, c);
    });
    grid.exchange(components).to_ghosted(owned, ghosted);
    grid.ghosted_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
      for (int c = 0; c < components; ++c) EXPECT_EQ(ghosted[offset * components + c], value(node, c));
    });
  }
}

TYPED_TEST(GridTest, ContributionsOfElementsAddUpAtTheOwners) {
  constexpr int Dim = TypeParam::value;
  const Grid<Dim> grid(PETSC_COMM_WORLD, odd_domain<Dim>(), skewed<Dim>);
  constexpr int components = 2;
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count() * components), 0.0);
  grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t) {
    for (const int corner : grid.corner_offsets()) {
      ghosted[(grid.first_corner(element) + corner) * components] += 1.0;
      ghosted[(grid.first_corner(element) + corner) * components + 1] +=
          static_cast<double>(grid.all_elements().offset(element));
    }
  });
  std::vector<double> owned(static_cast<std::size_t>(grid.owned_nodes().count() * components), 1e9);
  grid.exchange(components).add_to_owned(ghosted, owned);
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    double count = 0.0, numbers = 0.0;  // of the elements around the node
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      Index<Dim> element = node;
      for (int axis = 0; axis < Dim; ++axis) element[axis] -= (corner >> axis) & 1;
      if (!grid.all_elements().contains(element)) continue;
      count += 1.0;
      numbers += static_cast<double>(grid.all_elements().offset(element));
    }
    EXPECT_EQ(owned[offset * components], count);
    EXPECT_EQ(owned[offset * components + 1], numbers);
  });
}

TYPED_TEST(GridTest, MovedGridKeepsItsExchanges) {
  constexpr int Dim = TypeParam::value;
  Grid<Dim> first(PETSC_COMM_WORLD, odd_domain<Dim>(), skewed<Dim>);
  const NodeExchange<Dim>* exchange = &first.exchange(1);
  const Grid<Dim> grid(std::move(first));
  EXPECT_EQ(&grid.exchange(1), exchange);
  std::vector<double> owned(static_cast<std::size_t>(grid.owned_nodes().count()), 1.5);
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()));
  exchange->to_ghosted(owned, ghosted);
  for (const double value : ghosted) EXPECT_EQ(value, 1.5);
}

TEST(Grid, KnowsItsGeometry) {
  const Grid<3> box(PETSC_COMM_WORLD, odd_box, nullptr);
  EXPECT_DOUBLE_EQ(box.smallest_spacing(), 0.2);
  EXPECT_DOUBLE_EQ(box.largest_spacing(), 0.5);
  EXPECT_DOUBLE_EQ(box.element_volume(), 0.2 * 0.3 * 0.5);
  EXPECT_EQ(box.all_nodes().size, (Index<3>{8, 4, 6}));
  const Point<3> center = box.element_center({6, 0, 2});
  EXPECT_DOUBLE_EQ(center[0], 1.3);
  EXPECT_DOUBLE_EQ(center[1], 0.15);
  EXPECT_DOUBLE_EQ(center[2], 1.25);
  const Grid<2> plane(PETSC_COMM_WORLD, odd_plane, nullptr);
  EXPECT_DOUBLE_EQ(plane.element_volume(), 0.5 * 0.2 * 0.25);
  EXPECT_DOUBLE_EQ(plane.node_position({7, 3})[0], 3.5);
  EXPECT_DOUBLE_EQ(plane.node_position({7, 3})[1], 0.6);
}

TEST(Grid, RefusesMoreValuesThanIndicesHold) {
  if (sizeof(PetscInt) > 4) GTEST_SKIP() << "PETSc with 64-bit indices";
  const std::string nodes = test::refusal([] {
    Grid<3>(PETSC_COMM_WORLD, {{1, 1, 1}, {1999, 1999, 999}, 1.0}, nullptr);
  });
  EXPECT_NE(nodes.find("/domain/elements: [1999,1999,999] "), std::string::npos) << nodes;
  EXPECT_NE(nodes.find("12000000000 values"), std::string::npos) << nodes;
  EXPECT_NE(nodes.find("at most 2147483647"), std::string::npos) << nodes;
  const Grid<2> grid(PETSC_COMM_WORLD, {{1, 1}, {99, 99}, 1.0}, nullptr);
  const std::string values = test::refusal([&] { (void)grid.exchange(300000); });
  EXPECT_NE(values.find("3000000000 values"), std::string::npos) << values;
}

/// Before anything of that size is counted in integers or allocated.
TEST(Grid, RefusesMoreThanIntegersHold) {
  const std::string axis = test::refusal([] {
    Grid<2>(PETSC_COMM_WORLD, {{1, 1}, {2000000000, 1}, 1.0}, nullptr);
  });
  EXPECT_EQ(axis, "/domain/elements: [2000000000,1], at most 1000000000 are allowed along an axis");
  const std::string plane = test::refusal([] {
    Grid<3>(PETSC_COMM_WORLD, {{1, 1, 1}, {49999, 49999, 1}, 1.0}, nullptr);
  });
  EXPECT_NE(
      plane.find("/domain/elements: [49999,49999,1] make 2500000000 nodes across the last axis, at most "
                 "2147483647 are allowed"),
      std::string::npos)
      << plane;
}

TEST(Grid, RefusesAnEmptyDomain) {
  EXPECT_NE(test::refusal([] {
              Grid<2>(PETSC_COMM_WORLD, {{1, 1}, {4, 0}, 1.0}, nullptr);
            }).find("/domain/elements"),
            std::string::npos);
  EXPECT_NE(test::refusal([] {
              Grid<2>(PETSC_COMM_WORLD, {{1, -1}, {4, 4}, 1.0}, nullptr);
            }).find("/domain/size"),
            std::string::npos);
}

}  // namespace
}  // namespace fabseq
