// SPDX-License-Identifier: MIT
/// Gathered element fields of any width, and the transpose, against values and counts known in advance.
#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace fabseq {
namespace {

template <int Dim>
void check_halo(const Grid<Dim>& grid, const Index<Dim>& width) {
  const ElementHalo<Dim> halo(grid, width);
  const IndexBox<Dim>& owned = grid.owned_elements();
  for (int axis = 0; axis < Dim; ++axis) {
    const std::int64_t end = std::int64_t{owned.start[axis]} + owned.size[axis] + width[axis];
    EXPECT_EQ(halo.box().start[axis], std::max(owned.start[axis] - width[axis], 0));
    EXPECT_EQ(halo.box().start[axis] + halo.box().size[axis],
              std::min<std::int64_t>(end, grid.domain().elements[axis]));
  }

  const auto value = [&](const Index<Dim>& element) {
    return 3.0 + static_cast<double>(grid.all_elements().offset(element));
  };
  std::vector<double> field(static_cast<std::size_t>(owned.count()));
  owned.for_each([&](const Index<Dim>& element, std::int64_t offset) { field[offset] = value(element); });
  const std::vector<double> gathered = halo.gather(field);
  halo.box().for_each(
      [&](const Index<Dim>& element, std::int64_t offset) { EXPECT_EQ(gathered[offset], value(element)); });

  // How many ranks see each element, and the sum of their numbers.
  const double rank_number = 1.0 + rank_of(grid.comm());
  std::vector<double> seen(static_cast<std::size_t>(grid.all_elements().count()), 0.0);
  halo.box().for_each([&](const Index<Dim>& element, std::int64_t) {
    seen[grid.all_elements().offset(element)] += rank_number;
  });
  sum_in_place(grid.comm(), seen);
  const std::vector<double> added =
      halo.scatter_add(std::vector<double>(static_cast<std::size_t>(halo.box().count()), rank_number));
  EXPECT_EQ(test::whole_element_field<Dim>(grid, added), seen);
}

TEST(ElementHalo, GathersAnyWidthIn3D) {
  const Grid<3> grid(PETSC_COMM_WORLD, {{1.4, 0.9, 2.5}, {7, 3, 5}, 1.0}, nullptr);
  for (const Index<3>& width : std::vector<Index<3>>{
           {0, 0, 0}, {1, 1, 1}, {2, 0, 3}, {4, 4, 4}, {100, 100, 100}, {2147483647, 2147483647, 2147483647}})
    check_halo<3>(grid, width);
}

TEST(ElementHalo, GathersAcrossSeveralRanksIn2D) {
  // Ranks in a row, a few columns each: a width of 5 reaches past the next rank.
  const Grid<2> grid(PETSC_COMM_WORLD, {{8, 1}, {9, 1}, 1.0}, nullptr);
  for (const int width : {0, 1, 2, 3, 5, 8, 50}) check_halo<2>(grid, {width, width});
}

TEST(ElementHalo, TakesOneWidthForAllAxes) {
  const Grid<3> grid(PETSC_COMM_WORLD, {{1.4, 0.9, 2.5}, {7, 3, 5}, 1.0}, nullptr);
  const ElementHalo<3> one(grid, 2), each(grid, Index<3>{2, 2, 2});
  EXPECT_EQ(one.box().start, each.box().start);
  EXPECT_EQ(one.box().size, each.box().size);
}

}  // namespace
}  // namespace fabseq
