// SPDX-License-Identifier: MIT
/// Islands of distributed fields against those of the whole field.
#include "fabseq/lanes/island_map.h"

#include <gtest/gtest.h>

#include "support/islands.h"
#include "support/masked_grid.h"
#include <vector>

namespace fabseq {
namespace {

constexpr int lanes = 5;

template <class T>
class IslandMapTest : public testing::Test {};
TYPED_TEST_SUITE(IslandMapTest, test::Dimensions);

/// Islands of each lane: lane 0 has none, 1 both, 2 the first, 3 the second, 4 both; with and without holes.
template <int Dim>
struct Fields {
  explicit Fields(const test::Mask<Dim>& mask)
      : masked(PETSC_COMM_WORLD, islands.elements, mask, {Dim - 1, false}),
        hierarchy(masked.grid, masked.domain),
        map(hierarchy.level(0)) {}

  double stiffness(std::int64_t element, int lane) const {
    const auto index = masked.grid.all_elements().index(element);
    const bool first = lane == 1 || lane == 2 || lane == 4, second = lane == 1 || lane == 3 || lane == 4;
    const bool shown = (first && islands.blocks[0].contains(index)) ||
                       (second && islands.blocks[1].contains(index)) || index[Dim - 1] == 0;
    return shown ? 1.0 : test::soft;
  }
  /// Island of every node of the grid in a lane; -1 where there is no node, or a held one.
  StiffIslands expected(int lane) const {
    std::vector<double> field;
    masked.whole.elements.for_each([&](const Index<Dim>&, std::int64_t element) {
      field.push_back(masked.whole.active[element] != 0 ? stiffness(element, lane) : 0.0);
    });
    return find_stiff_islands<Dim>(islands.elements, field, islands.supported());
  }

  test::Islands<Dim> islands = test::two_islands<Dim>();
  test::MaskedGrid<Dim> masked;
  LaneHierarchy<Dim> hierarchy;
  IslandMap<Dim> map;
};

TYPED_TEST(IslandMapTest, FindsTheIslandsOfTheWholeField) {
  constexpr int Dim = TypeParam::value;
  const test::Mask<Dim> holes{"holes", [](const Index<Dim>& element) { return element[0] % 8 != 7; }};
  for (const auto& mask : {test::masks<Dim>()[0], holes}) {
    const Fields<Dim> fields(mask);
    const auto& mesh = fields.hierarchy.level(0).mesh;
    const auto stiffness = test::coefficient_array(
        mesh, fields.masked.grid.all_elements(), lanes,
        [&](std::int64_t element, int lane) { return fields.stiffness(element, lane); });
    const auto found = fields.map.find(stiffness, lanes);
    ASSERT_EQ(found.size(), static_cast<std::size_t>(lanes));
    for (int lane = 0; lane < lanes; ++lane) {
      SCOPED_TRACE(mask.name + " " + std::to_string(lane));
      const StiffIslands expected = fields.expected(lane);
      EXPECT_EQ(found[lane].count, expected.count);
      std::vector<int> island(mesh.nodes(), -1);
      std::int64_t last = -1, counted = 0;
      for (const auto& node : found[lane].nodes) {
        EXPECT_GT(node.node, last);
        last = node.node;
        island[node.node] = node.island;
        counted += node.counted ? 1 : 0;
      }
      std::int64_t expected_count = 0;
      fields.masked.whole.nodes.for_each([&](const Index<Dim>& node, std::int64_t offset) {
        const bool held = node[Dim - 1] == 0;
        const int wanted = expected.count > 0 && !held ? expected.node_island[offset] : -1;
        expected_count += wanted >= 0 ? 1 : 0;
        if (!mesh.node_box().contains(node) || mesh.node_number(node) < 0) return;
        EXPECT_EQ(island[mesh.node_number(node)], wanted) << to_text<Dim>(node);
      });
      EXPECT_EQ(sum(PETSC_COMM_WORLD, counted), expected_count);
    }
  }
}

TYPED_TEST(IslandMapTest, LanesWithoutIslandsHaveNoNodes) {
  constexpr int Dim = TypeParam::value;
  const Fields<Dim> fields(test::masks<Dim>()[0]);
  const auto stiffness =
      test::coefficient_array(fields.hierarchy.level(0).mesh, fields.masked.grid.all_elements(), 2,
                              [](std::int64_t, int) { return 1.0; });
  for (const auto& lane : fields.map.find(stiffness, 2)) {
    EXPECT_EQ(lane.count, 0);
    EXPECT_TRUE(lane.nodes.empty());
  }
}

}  // namespace
}  // namespace fabseq
