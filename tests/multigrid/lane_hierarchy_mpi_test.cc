// SPDX-License-Identifier: MIT
/// Levels of the lane multigrid against the whole grid's elements, coarsened step by step.
#include "multigrid/lane_hierarchy.h"
#include "support/level_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <vector>

namespace fabseq {
namespace {

template <class T>
class LaneHierarchyTest : public testing::Test {};
TYPED_TEST_SUITE(LaneHierarchyTest, test::Dimensions);

template <int Dim>
void expect_level(const LaneLevel<Dim>& level, const test::ExpectedLevel<Dim>& expected) {
  EXPECT_EQ(level.elements, expected.box.elements.size);
  const auto& mesh = level.mesh;
  mesh.element_box().for_each([&](const Index<Dim>& element, std::int64_t) {
    const bool active = expected.box.active[expected.box.elements.offset(element)] != 0;
    EXPECT_EQ(mesh.element_number(element) >= 0, active);
  });
  std::int64_t counted = 0, last = -1;
  for (const auto& range : level.counted) {
    EXPECT_GT(range.begin, last);
    last = range.end;
    counted += range.end - range.begin;
  }
  EXPECT_LE(last, mesh.nodes());
  const MPI_Comm all = PETSC_COMM_WORLD;
  std::int64_t elements = mesh.elements();
  const bool holds = level.shares.process_of(rank_of(all)) >= 0;
  EXPECT_EQ(level.lanes_dealt, level.shares.count() == 0);
  EXPECT_EQ(level.distributed, holds && level.shares.count() > 1);
  EXPECT_EQ(size_of(level.comm), level.distributed ? level.shares.count() : 1);
  EXPECT_TRUE(level.distributed || level.shared.nodes().empty());
  EXPECT_TRUE(holds || level.lanes_dealt || mesh.node_box().count() == 0);
  if (!level.lanes_dealt) {
    counted = sum(all, counted);
    elements = sum(all, elements);
  }
  EXPECT_EQ(elements, std::count(expected.box.active.begin(), expected.box.active.end(), 1));
  EXPECT_EQ(counted, std::count_if(expected.touching.begin(), expected.touching.end(),
                                   [](int elements_at) { return elements_at > 0; }));
  EXPECT_TRUE(std::is_sorted(level.fixed.begin(), level.fixed.end()));
}

TYPED_TEST(LaneHierarchyTest, LevelsAreTheCoarsenedGrid) {
  constexpr int Dim = TypeParam::value;
  for (const auto& size : test::sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      SCOPED_TRACE(mask.name + " " + to_text<Dim>(size));
      const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, mask, {Dim - 1, false});
      const auto hierarchy = test::hierarchy_of(masked);
      test::ExpectedLevel<Dim> expected{masked.whole};
      EXPECT_EQ(hierarchy.level(0).shares.count(), size_of(PETSC_COMM_WORLD));
      for (int index = 0; index < hierarchy.count(); ++index) {
        SCOPED_TRACE(index);
        const auto& level = hierarchy.level(index);
        expect_level(level, expected);
        if (index + 1 == hierarchy.count()) break;
        const auto& coarse = hierarchy.level(index + 1);
        for (int axis = 0; axis < Dim; ++axis)
          EXPECT_DOUBLE_EQ(coarse.spacing[axis], level.spacing[axis] * level.factors[axis]);
        const auto& parts = level.staged && !coarse.lanes_dealt ? level.stage : coarse.mesh;
        level.mesh.element_box().for_each([&](Index<Dim> element, std::int64_t) {
          const int number = level.mesh.element_number(element);
          for (int axis = 0; axis < Dim; ++axis) element[axis] /= level.factors[axis];
          EXPECT_TRUE(number < 0 || level.parent[number] == parts.element_number(element));
        });
        expected = expected.coarsened(level.factors);
      }
      const auto& last = hierarchy.level(hierarchy.count() - 1);
      EXPECT_EQ(last.lanes_dealt, size_of(PETSC_COMM_WORLD) > 1);
      EXPECT_LE(last.mesh.elements(), LaneHierarchy<Dim>::coarsest_elements(1));
    }
}

/// All weights of a fine node's interpolation have their coarse node.
TYPED_TEST(LaneHierarchyTest, CoarseNodesThatInterpolateAreThere) {
  constexpr int Dim = TypeParam::value;
  for (const auto& size : test::sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, mask, {Dim - 1, false});
      const auto hierarchy = test::hierarchy_of(masked);
      for (int index = 0; index + 1 < hierarchy.count(); ++index) {
        const auto& fine = hierarchy.level(index);
        const auto& parts = fine.staged ? fine.stage : hierarchy.level(index + 1).mesh;
        test::for_each_node(fine.mesh, [&](const Index<Dim>& node, std::int64_t) {
          IndexBox<Dim> around;
          for (int axis = 0; axis < Dim; ++axis) {
            around.start[axis] = node[axis] / fine.factors[axis];
            around.size[axis] = 1 + node[axis] % fine.factors[axis];
          }
          around.for_each([&](const Index<Dim>& at, std::int64_t) {
            ASSERT_TRUE(parts.node_box().contains(at)) << mask.name;
            EXPECT_GE(parts.node_number(at), 0) << mask.name << " " << index;
          });
        });
      }
    }
}

/// Axes with long elements wait until the others have caught up.
TYPED_TEST(LaneHierarchyTest, ElementsBecomeEquallyLong) {
  constexpr int Dim = TypeParam::value;
  Domain<Dim> domain;
  domain.elements.fill(Dim == 2 ? 64 : 20);
  for (int axis = 0; axis < Dim; ++axis) domain.size[axis] = domain.elements[axis] * (axis == 1 ? 3.7 : 1.0);
  const Grid<Dim> grid(PETSC_COMM_WORLD, domain, {});
  SystemDomain system{1, {}, std::vector<char>(grid.owned_nodes().count(), 0)};
  grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t) {
    system.first_corners.push_back(grid.first_corner(element));
  });
  const LaneHierarchy<Dim> hierarchy(grid, system);
  ASSERT_GT(hierarchy.count(), 2);
  for (int index = 0; index < 2; ++index)
    for (int axis = 0; axis < Dim; ++axis) EXPECT_EQ(hierarchy.level(index).factors[axis], axis == 1 ? 1 : 2);
}

TYPED_TEST(LaneHierarchyTest, TheLastLevelIsTheSameOnAllRanks) {
  constexpr int Dim = TypeParam::value;
  for (const auto& size : test::sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, mask, Dim, test::mixed_supports<Dim>());
      const auto hierarchy = test::hierarchy_of(masked);
      std::ostringstream text;
      for (int index = 0; index < hierarchy.count(); ++index)
        text << index << " on " << hierarchy.level(index).shares.count() << " "
             << to_text<Dim>(hierarchy.level(index).elements) << to_text<Dim>(hierarchy.level(index).factors);
      const auto& last = hierarchy.level(hierarchy.count() - 1);
      EXPECT_EQ(last.mesh.element_box().count(), IndexBox<Dim>({{}, last.elements}).count());
      for (const auto& run : last.mesh.node_runs()) text << run.node << to_text<Dim>(run.index) << run.length;
      for (const auto& row : last.mesh.rows()) text << row.element << " " << row.node[0] << row.length;
      for (const std::int64_t unknown : last.fixed) text << " " << unknown;
      EXPECT_TRUE(text.str() == broadcast(PETSC_COMM_WORLD, text.str())) << mask.name;
    }
}

/// There are as many levels as on one rank, and they are the same.
TYPED_TEST(LaneHierarchyTest, LevelsDoNotDependOnTheRanks) {
  constexpr int Dim = TypeParam::value;
  for (const auto& size : test::sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      const test::MaskedGrid<Dim> together(PETSC_COMM_WORLD, size, mask, Dim, test::mixed_supports<Dim>());
      const test::MaskedGrid<Dim> alone(PETSC_COMM_SELF, size, mask, Dim, test::mixed_supports<Dim>());
      const auto of_all = test::hierarchy_of(together), of_one = test::hierarchy_of(alone);
      // Several ranks have a copy of a finest level that is small enough to be the last.
      const int copies = of_one.count() == 1 && size_of(PETSC_COMM_WORLD) > 1 ? 1 : 0;
      ASSERT_EQ(of_all.count(), of_one.count() + copies) << mask.name << to_text<Dim>(size);
      for (int index = 0; index < of_one.count(); ++index)
        EXPECT_EQ(of_all.level(index).elements, of_one.level(index).elements);
    }
}

/// There is enough to do for all ranks on the second level, for fewer on the third, or even on the second.
TYPED_TEST(LaneHierarchyTest, FewerRanksHoldSmallerLevels) {
  constexpr int Dim = TypeParam::value;
  const int ranks = size_of(PETSC_COMM_WORLD);
  if (ranks > 4) GTEST_SKIP() << "ranks: written for up to 4 ranks";
  // The smaller one's second level has 1,015 elements in 2D and 1,386 in 3D: for two ranks, and for three.
  const std::vector<int> of_second = {ranks, ranks > (Dim == 2 ? 2 : 3) ? 2 : ranks};
  for (int which = 0; which < 2; ++which) {
    const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, test::sizes<Dim>()[which], test::masks<Dim>()[0],
                                       {0, false});
    const auto hierarchy = test::hierarchy_of(masked);
    ASSERT_GT(hierarchy.count(), 2);
    EXPECT_EQ(hierarchy.level(0).shares.count(), ranks);
    EXPECT_EQ(hierarchy.level(1).shares.count(), of_second[which]);
    EXPECT_EQ(hierarchy.level(hierarchy.count() - 1).lanes_dealt, ranks > 1);
  }
}

}  // namespace
}  // namespace fabseq
