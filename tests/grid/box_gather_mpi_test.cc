// SPDX-License-Identifier: MIT
/// Values in boxes that others own.
#include "fabseq/grid/box_gather.h"
#include "fabseq/grid/grid.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <class T>
class BoxGatherTest : public testing::Test {};
TYPED_TEST_SUITE(BoxGatherTest, test::Dimensions);

/// What a message carries: with a gap between its members.
struct Entry {
  double value = -1.0;
  bool known = false;
};

template <int Dim>
Grid<Dim> grid_of() {
  Domain<Dim> domain;
  domain.size.fill(1.0);
  domain.elements.fill(7);
  domain.elements[0] = 11;
  return Grid<Dim>(PETSC_COMM_WORLD, domain, nullptr);
}

/// Gathers numbers of elements in a box, and looks at all of them.
template <int Dim>
void expect_gathered(const Grid<Dim>& grid, const IndexBox<Dim>& wanted) {
  const IndexBox<Dim> all = grid.all_elements();
  const BoxGather<Dim> gather(grid.comm(), grid.owned_elements(), wanted);
  const auto found = gather.template gather<Entry>([&](const Index<Dim>& element) {
    EXPECT_TRUE(grid.owned_elements().contains(element));
    return Entry{static_cast<double>(all.offset(element)), true};
  });
  ASSERT_EQ(static_cast<std::int64_t>(found.size()), wanted.count());
  wanted.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    const bool inside = all.contains(element);
    EXPECT_EQ(found[offset].known, inside);
    EXPECT_EQ(found[offset].value, inside ? static_cast<double>(all.offset(element)) : -1.0);
  });
  std::vector<int> others(found.size(), 7);
  gather.gather_others([](const Index<Dim>&) { return 3; }, others);
  wanted.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    const bool of_another = all.contains(element) && !grid.owned_elements().contains(element);
    EXPECT_EQ(others[offset], of_another ? 3 : 7);
  });
}

TYPED_TEST(BoxGatherTest, BringsWhatIsAroundAndLeavesWhatIsOutside) {
  constexpr int Dim = TypeParam::value;
  const Grid<Dim> grid = grid_of<Dim>();
  expect_gathered<Dim>(grid, ringed(grid.owned_elements()));
}

TYPED_TEST(BoxGatherTest, BoxesNeedNotLieNearEachOther) {
  constexpr int Dim = TypeParam::value;
  const Grid<Dim> grid = grid_of<Dim>();
  const int rank = rank_of(grid.comm());
  IndexBox<Dim> wanted;
  wanted.size.fill(3);
  for (int axis = 0; axis < Dim; ++axis) wanted.start[axis] = (5 * rank + 3 * axis) % 7;
  if (rank == 1) wanted.size[Dim - 1] = 0;
  expect_gathered<Dim>(grid, wanted);
  expect_gathered<Dim>(grid, grid.all_elements());
}

}  // namespace
}  // namespace fabseq
