// SPDX-License-Identifier: MIT
/// Supports of coarse levels against those of the whole grid, coarsened step by step.
#include "multigrid/lane_hierarchy.h"
#include "support/level_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

template <class T>
class CoarseSupportsTest : public testing::Test {};
TYPED_TEST_SUITE(CoarseSupportsTest, test::Dimensions);

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
TYPED_TEST(CoarseSupportsTest, PlatesOnAllFacesAreHeldOnAllLevels) {
  constexpr int Dim = TypeParam::value;
  Index<Dim> odd;
  const int counts[] = {37, 23, 11};
  std::copy_n(counts, Dim, odd.begin());
  for (int axis = 0; axis < Dim; ++axis)
    for (const bool upper : {false, true}) {
      SCOPED_TRACE(std::to_string(axis) + (upper ? " upper" : " lower"));
      const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, odd, test::masks<Dim>()[0], {axis, upper});
      const auto hierarchy = test::hierarchy_of(masked);
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
TYPED_TEST(CoarseSupportsTest, SupportsFollowThoseOfTheFinerLevel) {
  constexpr int Dim = TypeParam::value;
  for (const auto& size : test::sizes<Dim>())
    for (const auto& mask : test::masks<Dim>()) {
      SCOPED_TRACE(mask.name + " " + to_text<Dim>(size));
      const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, mask, Dim, test::mixed_supports<Dim>());
      const auto hierarchy = test::hierarchy_of(masked);
      test::ExpectedLevel<Dim> fine{masked.whole};
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
TYPED_TEST(CoarseSupportsTest, SupportsBetweenCoarseNodesAreKept) {
  constexpr int Dim = TypeParam::value;
  Index<Dim> size;
  size.fill(Dim == 2 ? 40 : 12);
  const auto odd_nodes = [](const Index<Dim>& node, int) {
    return node[Dim - 1] == 0 && std::all_of(node.begin(), node.end() - 1, [](int i) { return i % 2 == 1; });
  };
  const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, test::masks<Dim>()[0], Dim, odd_nodes);
  const auto hierarchy = test::hierarchy_of(masked);
  for (int index = 0; index < hierarchy.count(); ++index)
    EXPECT_GT(test::largest(whole_fixed(hierarchy.level(index), Dim)), 0.0) << index;
}

/// Nor may one of two be lost, because the other is in line with the coarse nodes.
TYPED_TEST(CoarseSupportsTest, EverySupportIsKept) {
  constexpr int Dim = TypeParam::value;
  Index<Dim> size;
  size.fill(Dim == 2 ? 40 : 12);
  const auto planes = [](const Index<Dim>& node, int) { return node[Dim - 1] == 0 || node[Dim - 1] == 7; };
  const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, test::masks<Dim>()[0], Dim, planes);
  const auto hierarchy = test::hierarchy_of(masked);
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
TYPED_TEST(CoarseSupportsTest, StripsStayStrips) {
  constexpr int Dim = TypeParam::value;
  if (Dim == 2) return;
  Index<Dim> size;
  size.fill(24);
  const auto strip = [](const Index<Dim>& node, int) { return node[Dim - 1] <= 1 && node[1] == 1; };
  const test::MaskedGrid<Dim> masked(PETSC_COMM_WORLD, size, test::masks<Dim>()[0], Dim, strip);
  const auto hierarchy = test::hierarchy_of(masked);
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

}  // namespace
}  // namespace fabseq
