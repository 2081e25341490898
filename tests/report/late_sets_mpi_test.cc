// SPDX-License-Identifier: MIT
/// Node sets that the last layers build, on a block in planar layers.
#include "fabseq/report/late_sets.h"
#include "fabseq/responses/response_type.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>

namespace fabseq {
namespace {

using test::box;

/// Unit cubes, one layer each along z.
const Domain<3> tower_domain{{2.0, 3.0, 24.0}, {2, 3, 24}, 1.0};

class LateSetsTest : public testing::Test {
 protected:
  /// Those of sets at these heights (`low` to `high`), each measured by an own term; named by the height.
  std::vector<LateSet> late(const std::vector<std::array<double, 2>>& heights, bool released = false) const {
    return late(tower_, heights, released);
  }
  static std::vector<LateSet> late(const test::PartOnGrid<3>& tower,
                                   const std::vector<std::array<double, 2>>& heights, bool released = false) {
    std::map<std::string, NodeSet> sets;
    std::vector<Term> terms;
    for (const auto& [low, high] : heights) {
      const std::string name = "from_" + std::to_string(static_cast<int>(low));
      sets.emplace(name, make_node_set<3>(tower.part, name, {box({0, 0, low}, {2, 3, high}), 0}));
      const std::string term =
          R"({"type": "distortion", "nodes": ")" + name + (released ? R"(", "after_release": true})" : "\"}");
      terms.push_back(make_term(TermList::objective, parse_json(term, "term")));
    }
    std::vector<double> layer;
    for (const int element : tower.part.elements())
      layer.push_back(1.0 + tower.grid.owned_elements().index(element)[2]);
    return late_sets<3>(tower.part, sets, terms, layer);
  }

  test::PartOnGrid<3> tower_{tower_domain, box({0, 0, 0}, {2, 3, 24})};
};

TEST_F(LateSetsTest, HasSetsWithHalfOrMoreOfTheirNodesInTheLastTenthOfLayers) {
  // A node belongs to the layer below it, the first around it; the last two of 24 layers are the last.
  const std::vector<LateSet> found = late({{24, 24}, {22, 24}, {21, 24}, {20, 24}, {0, 24}, {3, 5}});
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].name, "from_21");
  EXPECT_DOUBLE_EQ(found[0].share, 0.5);
  EXPECT_EQ(found[1].name, "from_22");
  EXPECT_DOUBLE_EQ(found[1].share, 2.0 / 3.0);
  EXPECT_EQ(found[2].name, "from_24");
  EXPECT_DOUBLE_EQ(found[2].share, 1.0);
  EXPECT_EQ(found[2].layers, 2);
  EXPECT_EQ(
      found[2].words(),
      "the last 2 layers build 100 % of node set from_24, which moves mostly with its own layer: thinner "
      "layers make this motion small in every sequence, planar ones too, and the gain may vanish");
}

/// Nodes of the substrate move from the first layer on: two thirds of the top are the part's, half of these
/// stand at the substrate.
TEST_F(LateSetsTest, LeavesOutNodesOfTheSubstrate) {
  PartDescription description{box({1, 0, 0}, {2, 3, 24}), false};
  description.substrate = box({0, 0, 0}, {1, 3, 24});
  EXPECT_TRUE(late(test::PartOnGrid<3>(tower_domain, description), {{24, 24}}).empty());
}

TEST_F(LateSetsTest, LeavesOutWhatIsMeasuredAfterTheRelease) { EXPECT_TRUE(late({{24, 24}}, true).empty()); }

}  // namespace
}  // namespace fabseq
