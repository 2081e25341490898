// SPDX-License-Identifier: MIT
/// Levels of the lane multigrid against the whole grid's elements and supports, coarsened step by step.
#include "fabseq/lanes/lane_hierarchy.h"

#include <gtest/gtest.h>

#include "support/masked_grid.h"
#include <algorithm>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

/// A level as it must be, whole.
template <int Dim>
struct ExpectedLevel {
  test::MaskedBox<Dim> box;
  std::vector<int> touching = box.touching_elements();

  /// The next one.
  ExpectedLevel coarsened(const Index<Dim>& factors) const {
    IndexBox<Dim> elements;
    for (int axis = 0; axis < Dim; ++axis)
      elements.size[axis] = (box.elements.size[axis] + factors[axis] - 1) / factors[axis];
    std::vector<char> active(elements.count(), 0);
    box.for_each_active([&](Index<Dim> element, std::int64_t) {
      for (int axis = 0; axis < Dim; ++axis) element[axis] /= factors[axis];
      active[elements.offset(element)] = 1;
    });
    return {{elements, {"", [&](const Index<Dim>& e) { return active[elements.offset(e)] != 0; }}}};
  }
};

/// Some that several ranks hold on several levels, one whose second level is for fewer, some with odd counts,
/// some tiny, some with long elements.
template <int Dim>
std::vector<Index<Dim>> sizes() {
  if constexpr (Dim == 2)
    return {{96, 97}, {70, 58}, {37, 23}, {5, 4}, {3, 400}};
  else
    return {{24, 25, 24}, {12, 21, 22}, {11, 9, 13}, {2, 3, 2}, {1, 60, 20}};
}

template <int Dim>
LaneHierarchy<Dim> hierarchy_of(const test::MaskedGrid<Dim>& masked) {
  return LaneHierarchy<Dim>(masked.grid, masked.domain);
}

template <class T>
class LaneHierarchyTest : public testing::Test {};
TYPED_TEST_SUITE(LaneHierarchyTest, test::Dimensions);

template <int Dim>
void expect_level(const LaneLevel<Dim>& level, const ExpectedLevel<Dim>& expected) {
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
  for (const auto& size : sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      SCOPED_TRACE(mask.name + " " + to_text<Dim>(size));
      const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, mask, {Dim - 1, false});
      const auto hierarchy = hierarchy_of(masked);
      ExpectedLevel<Dim> expected{masked.whole};
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
      EXPECT_LE(last.mesh.elements(), LaneHierarchy<Dim>::coarsest_elements);
    }
}

/// All weights of a fine node's interpolation have their coarse node.
TYPED_TEST(LaneHierarchyTest, CoarseNodesThatInterpolateAreThere) {
  constexpr int Dim = TypeParam::value;
  for (const auto& size : sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, mask, {Dim - 1, false});
      const auto hierarchy = hierarchy_of(masked);
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

/// Held unknowns of a level, 1 or 0 on all nodes of its grid; holders must agree.
template <int Dim>
std::vector<double> whole_fixed(const LaneLevel<Dim>& level, int components) {
  IndexBox<Dim> all{Index<Dim>{}, level.elements};
  for (int& extent : all.size) ++extent;
  const LaneArray marks =
      test::lane_array(level.mesh, all, components, 1, [](std::int64_t, int) { return 0.0; });
  LaneArray held = marks;
  for (const std::int64_t unknown : level.fixed) held[unknown] = 1.0;
  return test::whole_lane(PETSC_COMM_WORLD, level.mesh, all, held, components, 1, 0);
}

/// A plate on each face, at the upper ones not in line with the coarse nodes: what is held is the last plane,
/// and perhaps, where other axes are padded, too, nodes next to it at their end.
TYPED_TEST(LaneHierarchyTest, PlatesOnAllFacesAreHeldOnAllLevels) {
  constexpr int Dim = TypeParam::value;
  Index<Dim> odd;
  const int counts[] = {37, 23, 11};
  std::copy_n(counts, Dim, odd.begin());
  for (int axis = 0; axis < Dim; ++axis)
    for (const bool upper : {false, true}) {
      SCOPED_TRACE(std::to_string(axis) + (upper ? " upper" : " lower"));
      const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, odd, test::masks<Dim>()[0], {axis, upper});
      const auto hierarchy = hierarchy_of(masked);
      ASSERT_GT(hierarchy.count(), 1);
      for (int index = 0; index < hierarchy.count(); ++index) {
        const auto& level = hierarchy.level(index);
        test::for_each_node(level.mesh, [&](const Index<Dim>& node, std::int64_t number) {
          const bool held = node[axis] == (upper ? level.elements[axis] : 0);
          bool at_another_end = false;
          for (int other = 0; other < Dim; ++other)
            at_another_end = at_another_end || (other != axis && node[other] == level.elements[other]);
          for (int a = 0; a < Dim && (held || !at_another_end); ++a)
            EXPECT_EQ(std::binary_search(level.fixed.begin(), level.fixed.end(), number * Dim + a), held)
                << index << " " << to_text<Dim>(node);
        });
      }
    }
}

/// A coarse unknown is held like the fine one at its place; without one, if something next to it is held.
/// What would be held by none of them holds all it interpolates from.
TYPED_TEST(LaneHierarchyTest, SupportsFollowThoseOfTheFinerLevel) {
  constexpr int Dim = TypeParam::value;
  for (const auto& size : sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      SCOPED_TRACE(mask.name + " " + to_text<Dim>(size));
      const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, mask, Dim, test::mixed_supports<Dim>());
      const auto hierarchy = hierarchy_of(masked);
      ExpectedLevel<Dim> fine{masked.whole};
      auto held = whole_fixed(hierarchy.level(0), Dim);
      masked.whole.nodes.for_each([&](const Index<Dim>& node, std::int64_t offset) {
        for (int a = 0; a < Dim; ++a)
          EXPECT_EQ(held[offset * Dim + a] == 1.0,
                    fine.touching[offset] > 0 && test::mixed_supports<Dim>()(node, a));
      });
      for (int index = 0; index + 1 < hierarchy.count(); ++index) {
        const auto factors = hierarchy.level(index).factors;
        const auto coarse = fine.coarsened(factors);
        const auto coarse_held = whole_fixed(hierarchy.level(index + 1), Dim);
        std::vector<double> expected(coarse_held.size(), 0.0);
        coarse.box.nodes.for_each([&](const Index<Dim>& node, std::int64_t offset) {
          IndexBox<Dim> around;  // fine nodes that this one interpolates to
          Index<Dim> place;
          for (int axis = 0; axis < Dim; ++axis) {
            place[axis] = node[axis] * factors[axis];
            const int first = std::max(0, place[axis] - factors[axis] + 1);
            const int last = std::min(fine.box.nodes.size[axis] - 1, place[axis] + factors[axis] - 1);
            around.start[axis] = first;
            around.size[axis] = std::max(0, last - first + 1);
          }
          const bool there =
              fine.box.nodes.contains(place) && fine.touching[fine.box.nodes.offset(place)] > 0;
          for (int a = 0; a < Dim; ++a) {
            bool nearby = false;
            around.for_each([&](const Index<Dim>& at, std::int64_t) {
              nearby = nearby || held[fine.box.nodes.offset(at) * Dim + a] == 1.0;
            });
            expected[offset * Dim + a] = there ? held[fine.box.nodes.offset(place) * Dim + a] : nearby;
          }
        });
        const std::vector<double> without_lost = expected;
        fine.box.nodes.for_each([&](const Index<Dim>& node, std::int64_t offset) {
          IndexBox<Dim> sources;  // coarse nodes that this one interpolates from
          for (int axis = 0; axis < Dim; ++axis) {
            sources.start[axis] = node[axis] / factors[axis];
            sources.size[axis] = node[axis] % factors[axis] == 0 ? 1 : 2;
          }
          for (int a = 0; a < Dim; ++a) {
            bool kept = false;
            const auto place = [&](const Index<Dim>& at) { return coarse.box.nodes.offset(at) * Dim + a; };
            sources.for_each(
                [&](const Index<Dim>& at, std::int64_t) { kept = kept || without_lost[place(at)] == 1.0; });
            if (held[offset * Dim + a] == 1.0 && !kept)
              sources.for_each([&](const Index<Dim>& at, std::int64_t) { expected[place(at)] = 1.0; });
          }
        });
        coarse.box.nodes.for_each([&](const Index<Dim>& node, std::int64_t offset) {
          for (int a = 0; a < Dim; ++a)
            EXPECT_EQ(coarse_held[offset * Dim + a] == 1.0,
                      coarse.touching[offset] > 0 && expected[offset * Dim + a] == 1.0)
                << index << " " << to_text<Dim>(node);
        });
        fine = coarse;
        held = coarse_held;
      }
    }
}

/// Nothing is held at a place of a coarse node: supports must not get lost all the same.
TYPED_TEST(LaneHierarchyTest, SupportsBetweenCoarseNodesAreKept) {
  constexpr int Dim = TypeParam::value;
  Index<Dim> size;
  size.fill(Dim == 2 ? 40 : 12);
  const auto odd_nodes = [](const Index<Dim>& node, int) {
    return node[Dim - 1] == 0 && std::all_of(node.begin(), node.end() - 1, [](int i) { return i % 2 == 1; });
  };
  const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, test::masks<Dim>()[0], Dim, odd_nodes);
  const auto hierarchy = hierarchy_of(masked);
  for (int index = 0; index < hierarchy.count(); ++index)
    EXPECT_GT(test::largest(whole_fixed(hierarchy.level(index), Dim)), 0.0) << index;
}

/// Nor may one of two be lost, because the other is in line with the coarse nodes.
TYPED_TEST(LaneHierarchyTest, EverySupportIsKept) {
  constexpr int Dim = TypeParam::value;
  Index<Dim> size;
  size.fill(Dim == 2 ? 40 : 12);
  const auto planes = [](const Index<Dim>& node, int) { return node[Dim - 1] == 0 || node[Dim - 1] == 7; };
  const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, test::masks<Dim>()[0], Dim, planes);
  const auto hierarchy = hierarchy_of(masked);
  ASSERT_GT(hierarchy.count(), 1);
  Index<Dim> near{}, far{};
  ASSERT_EQ(hierarchy.level(0).factors[Dim - 1], 2);
  near[Dim - 1] = 3;
  far[Dim - 1] = 4;
  const auto held = whole_fixed(hierarchy.level(1), Dim);
  Index<Dim> nodes = hierarchy.level(1).elements;
  for (int& count : nodes) ++count;
  const IndexBox<Dim> box{{}, nodes};
  for (const Index<Dim>& node : {Index<Dim>{}, near, far}) EXPECT_EQ(held[box.offset(node) * Dim], 1.0);
}

/// A strip of two lines of nodes must not become one line, about which a body could turn.
TYPED_TEST(LaneHierarchyTest, StripsStayStrips) {
  constexpr int Dim = TypeParam::value;
  if (Dim == 2) return;
  Index<Dim> size;
  size.fill(24);
  const auto strip = [](const Index<Dim>& node, int) { return node[Dim - 1] <= 1 && node[1] == 1; };
  const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, test::masks<Dim>()[0], Dim, strip);
  const auto hierarchy = hierarchy_of(masked);
  ASSERT_GT(hierarchy.count(), 2);
  for (int index = 0; index < hierarchy.count(); ++index) {
    const auto held = whole_fixed(hierarchy.level(index), Dim);
    Index<Dim> nodes = hierarchy.level(index).elements;
    for (int& count : nodes) ++count;
    std::set<std::pair<int, int>> lines;
    const IndexBox<Dim> box{{}, nodes};
    box.for_each([&](const Index<Dim>& node, std::int64_t offset) {
      if (held[offset * Dim] == 1.0) lines.emplace(node[1], node[Dim - 1]);
    });
    EXPECT_GE(lines.size(), 2u) << index;
  }
}

TYPED_TEST(LaneHierarchyTest, TheLastLevelIsTheSameOnAllRanks) {
  constexpr int Dim = TypeParam::value;
  for (const auto& size : sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, mask, Dim, test::mixed_supports<Dim>());
      const auto hierarchy = hierarchy_of(masked);
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
  for (const auto& size : sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      const test::MaskedGrid<Dim> together(PETSC_COMM_WORLD, size, mask, Dim, test::mixed_supports<Dim>());
      const test::MaskedGrid<Dim> alone(PETSC_COMM_SELF, size, mask, Dim, test::mixed_supports<Dim>());
      const auto of_all = hierarchy_of(together), of_one = hierarchy_of(alone);
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
  const std::vector<int> of_second = {ranks, ranks == 4 ? 2 : ranks};  // of 1,386 elements in 3D
  for (int which = 0; which < 2; ++which) {
    const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, sizes<Dim>()[which], test::masks<Dim>()[0],
                                       {0, false});
    const auto hierarchy = hierarchy_of(masked);
    ASSERT_GT(hierarchy.count(), 2);
    EXPECT_EQ(hierarchy.level(0).shares.count(), ranks);
    EXPECT_EQ(hierarchy.level(1).shares.count(), of_second[which]);
    EXPECT_EQ(hierarchy.level(hierarchy.count() - 1).lanes_dealt, ranks > 1);
  }
}

}  // namespace
}  // namespace fabseq
