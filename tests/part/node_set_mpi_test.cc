// SPDX-License-Identifier: MIT
/// Node sets: which nodes, and which of them are samples, against the rule written out by hand.
#include "fabseq/part/node_set.h"
#include "support/refusal.h"
#include "support/shapes.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace fabseq {
namespace {

using test::box;

/// Lexicographic numbers of the nodes of a set, on all ranks.
template <int Dim>
std::vector<std::int64_t> numbers_of(const Grid<Dim>& grid, const NodeSet& set) {
  std::vector<double> marks(static_cast<std::size_t>(grid.owned_nodes().count()), 0.0);
  for (const int offset : set.owned) marks[offset] += 1.0;
  const std::vector<double> whole = test::whole_node_field<Dim>(grid, marks);
  std::vector<std::int64_t> numbers;
  for (std::size_t n = 0; n < whole.size(); ++n)
    if (whole[n] != 0.0) numbers.push_back(static_cast<std::int64_t>(n));
  EXPECT_EQ(static_cast<std::int64_t>(numbers.size()), set.count);
  return numbers;
}

const Domain<3> odd{{1.4, 0.9, 2.5}, {7, 3, 5}, 1.0};

class NodeSetTest : public testing::Test {
 protected:
  NodeSetTest() : grid_(PETSC_COMM_WORLD, odd, nullptr), part_(grid_, {block(), false}, {2, false}) {}
  /// The lower three layers of elements.
  static Shape block() { return box({0, 0, 0}, {1.4, 0.9, 1.5}); }
  std::int64_t number(int x, int y, int z) const { return grid_.all_nodes().offset({x, y, z}); }

  Grid<3> grid_;
  Part<3> part_;
};

TEST_F(NodeSetTest, HoldsNodesOnTheShapeThatTouchThePart) {
  const NodeSet edge = make_node_set<3>(part_, "edge", {box({1.4, 0, 1.5}, {1.4, 0.9, 1.5}), 0});
  EXPECT_EQ(edge.name, "edge");
  EXPECT_EQ(numbers_of<3>(grid_, edge),
            (std::vector<std::int64_t>{number(7, 0, 3), number(7, 1, 3), number(7, 2, 3), number(7, 3, 3)}));
  // All above the part's top is left out.
  const NodeSet column = make_node_set<3>(part_, "column", {box({0, 0, 0}, {0, 0, 9}), 0});
  EXPECT_EQ(numbers_of<3>(grid_, column),
            (std::vector<std::int64_t>{number(0, 0, 0), number(0, 0, 1), number(0, 0, 2), number(0, 0, 3)}));
}

TEST_F(NodeSetTest, SpreadsSamplesAlongTheLongestEdge) {
  // The face y = 0: 8 x 4 nodes, 1.4 wide and 1.5 high, so ordered along z, then by number. n = 32, k = 5: 0,
  // 8, 16, 23, 31.
  const NodeSet face = make_node_set<3>(part_, "face", {box({0, 0, 0}, {1.4, 0, 1.5}), 5});
  // floor(i 31/4 + 1/2) = 0, 8, 16, 23, 31; node m of the order is (m % 8, 0, m / 8).
  EXPECT_EQ(numbers_of<3>(grid_, face),
            (std::vector<std::int64_t>{number(0, 0, 0), number(0, 0, 1), number(0, 0, 2), number(7, 0, 2),
                                       number(7, 0, 3)}));
  // The top: 1.4 x 0.9, ordered along x, ties by number (y). n = 32, k = 3: 0, 16, 31; node m is (m / 4, m %
  // 4).
  const NodeSet top = make_node_set<3>(part_, "top", {box({0, 0, 1.5}, {1.4, 0.9, 1.5}), 3});
  EXPECT_EQ(numbers_of<3>(grid_, top),
            (std::vector<std::int64_t>{number(0, 0, 3), number(4, 0, 3), number(7, 3, 3)}));
}

TEST_F(NodeSetTest, FollowsTheIndexRuleForAnyCount) {
  const Shape edge = box({0, 0.9, 1.5}, {1.4, 0.9, 1.5});  // 8 nodes
  for (int samples = 2; samples <= 8; ++samples) {
    const NodeSet set = make_node_set<3>(part_, "edge", {edge, samples});
    std::vector<std::int64_t> expected;
    for (int i = 0; i < samples; ++i)
      expected.push_back(number(static_cast<int>(std::floor(i * 7.0 / (samples - 1) + 0.5)), 3, 3));
    EXPECT_EQ(numbers_of<3>(grid_, set), expected) << samples;
  }
  EXPECT_EQ(numbers_of<3>(grid_, make_node_set<3>(part_, "edge", {edge, 1})),
            (std::vector<std::int64_t>{number(0, 3, 3)}));
}

/// A block of 7 x 3 x 3 elements: its surface, and all of it, however far the shape reaches.
TEST_F(NodeSetTest, SurfacesHaveNoInnerNodes) {
  NodeSetDescription skin{box({0, 0, 0}, {9, 9, 9})};
  skin.surface = true;
  EXPECT_EQ(make_node_set<3>(part_, "skin", skin).count, 8 * 4 * 4 - 6 * 2 * 2);
  NodeSetDescription all;
  all.all = true;
  EXPECT_EQ(make_node_set<3>(part_, "all", all).count, 8 * 4 * 4);
  all.surface = true;
  const NodeSet both = make_node_set<3>(part_, "both", all);
  EXPECT_EQ(numbers_of<3>(grid_, both), numbers_of<3>(grid_, make_node_set<3>(part_, "skin", skin)));
  all.samples = 3;
  EXPECT_EQ(numbers_of<3>(grid_, make_node_set<3>(part_, "samples", all)).front(), number(0, 0, 0));
}

/// Where a substrate carries the part, the nodes between them are inner ones.
TEST_F(NodeSetTest, SubstratesCloseSurfaces) {
  PartDescription description{box({0, 0, 0.5}, {1.4, 0.9, 1.5}), false};
  description.substrate = box({0, 0, 0}, {1.4, 0.9, 0.5});
  const Part<3> part(grid_, description, {2, false});
  NodeSetDescription skin;
  skin.all = skin.surface = true;
  const std::vector<std::int64_t> numbers = numbers_of<3>(grid_, make_node_set<3>(part, "skin", skin));
  EXPECT_EQ(std::count(numbers.begin(), numbers.end(), number(3, 2, 1)), 0);
  EXPECT_EQ(std::count(numbers.begin(), numbers.end(), number(3, 2, 3)), 1);
  EXPECT_EQ(std::count(numbers.begin(), numbers.end(), number(3, 0, 1)), 1);
}

TEST_F(NodeSetTest, RefusesEmptySetsAndTooManySamples) {
  const auto refusal = [&](const Shape& shape, int samples) {
    return test::refusal([&] { (void)make_node_set<3>(part_, "rim", {shape, samples}); });
  };
  EXPECT_EQ(refusal(box({0, 0, 2}, {1.4, 0.9, 2.5}), 0).rfind("/node_sets/rim: no node", 0), 0u);
  const std::string many = refusal(box({0, 0.9, 1.5}, {1.4, 0.9, 1.5}), 9);
  EXPECT_EQ(many, "/node_sets/rim/samples: 9 of a set of 8 nodes, needs 0 (all) to 8");
}

TEST(NodeSet2D, TakesTheFirstAxisAmongEqualEdges) {
  // 0.7/7 and 2.1/21: edges equal up to rounding; the square's nodes are ordered along x.
  const Grid<2> grid(PETSC_COMM_WORLD, {{0.7, 2.1}, {7, 21}, 1.0}, nullptr);
  const Part<2> part(grid, {box({0, 0}, {0.7, 2.1}), false}, {1, false});
  const NodeSet set = make_node_set<2>(part, "square", {box({0, 0}, {0.7, 0.7}), 2});
  EXPECT_EQ(set.count, 2);
  const NodeSet three = make_node_set<2>(part, "square", {box({0, 0}, {0.7, 0.7}), 3});
  // n = 64, indices 0, 32, 63 of the order by x, then y: (0,0), (4,0), (7,7).
  EXPECT_EQ(numbers_of<2>(grid, three), (std::vector<std::int64_t>{0, 4, 7 * 8 + 7}));
}

}  // namespace
}  // namespace fabseq
