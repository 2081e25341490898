// SPDX-License-Identifier: MIT
/// Islands of distributed fields against those of the whole field.
#include "islands/island_map.h"
#include "support/islands.h"
#include "support/masked_grid.h"
#include "support/serial_islands.h"

#include <gtest/gtest.h>

#include <cmath>
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
  test::SerialIslands expected(int lane) const {
    std::vector<double> field;
    masked.whole.elements.for_each([&](const Index<Dim>&, std::int64_t element) {
      field.push_back(masked.whole.active[element] != 0 ? stiffness(element, lane) : 0.0);
    });
    return test::find_serial_islands<Dim>(islands.elements, field, islands.supported());
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
      const test::SerialIslands expected = fields.expected(lane);
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

/// A field by the number of an element; the mask says where elements are.
template <int Dim>
struct Pattern {
  const char* name;
  std::function<double(const Index<Dim>&, int)> stiffness;  ///< in a lane
};

double power_of_ten(double exponent) { return std::pow(10.0, exponent); }

template <int Dim>
std::int64_t number_of(const Index<Dim>& element) {
  std::int64_t number = 0;
  for (const int i : element) number = number * 64 + i;
  return number;
}

/// Whether a wall one element thick winds inwards in the plane of the first and the last axis: every ring but
/// for a gap that leads to the next.
template <int Dim>
bool on_spiral(const Index<Dim>& element, const Index<Dim>& elements) {
  const int x = element[0], y = element[Dim - 1];
  const int ring = std::min(std::min(x, elements[0] - 1 - x), std::min(y, elements[Dim - 1] - 1 - y));
  if (x == ring && y == ring + 1) return false;  // the gap
  if (ring % 2 == 1) return x == ring && y == ring + 1;
  return true;
}

template <int Dim>
std::vector<Pattern<Dim>> patterns(const Index<Dim>& elements) {
  const auto noise = [](const Index<Dim>& element, int lane) {
    return test::noise(number_of<Dim>(element), 20 + lane);
  };
  const auto parity = [](const Index<Dim>& element) {
    int sum = 0;
    for (const int i : element) sum += i;
    return sum % 2;
  };
  return {
      {"noise", [=](const auto& e, int lane) { return power_of_ten(-9.0 * noise(e, lane)); }},
      {"few values",
       [=](const auto& e, int lane) { return power_of_ten(-3.0 * std::floor(4.0 * noise(e, lane))); }},
      {"voxels", [=](const auto& e, int lane) { return noise(e, lane) < 0.25 + 0.1 * lane ? 1.0 : 1e-9; }},
      {"voxels in a slope",
       [=](const auto& e, int lane) {
         return (noise(e, lane) < 0.3 ? 1.0 : 1e-6) * power_of_ten(-0.1 * e[0] + 0.05 * lane * e[1]);
       }},
      {"waves",
       [=](const auto& e, int lane) {
         double phase = 0.0;
         for (int axis = 0; axis < Dim; ++axis) phase += std::sin(0.7 * e[axis] + lane + axis);
         return power_of_ten(std::min(0.0, 2.0 * phase - 2.0));
       }},
      {"checkerboard", [=](const auto& e, int lane) { return parity(e) == lane % 2 ? 1.0 : test::soft; }},
      {"corner to corner",
       [=](const auto& e, int lane) {
         int blocks = 0;
         for (const int i : e) blocks += i / (3 + lane);
         return blocks % 2 == 0 && e[Dim - 1] > 1 ? 1.0 : test::soft;
       }},
      {"spiral", [=](const auto& e, int lane) {
         return on_spiral<Dim>(e, elements) ? (lane < 2 ? 1.0 : power_of_ten(-3.0 * noise(e, lane))) : 1e-7;
       }}};
}

/// On any number of ranks; contrasts and numbers of islands that leave out some, also of equal size.
TYPED_TEST(IslandMapTest, FindsTheSameAsTheSinkingOfTheWholeField) {
  constexpr int Dim = TypeParam::value;
  const auto elements = test::two_islands<Dim>().elements;
  for (const auto& mask : {test::masks<Dim>()[0], test::masks<Dim>()[1], test::masks<Dim>()[3]}) {
    const Fields<Dim> fields(mask);
    const auto& level = fields.hierarchy.level(0);
    const auto all = fields.masked.grid.all_elements();
    std::vector<char> supported;
    all.for_each([&](const Index<Dim>& e, std::int64_t) { supported.push_back(e[Dim - 1] == 0 ? 1 : 0); });
    for (const Pattern<Dim>& pattern : patterns<Dim>(elements))
      for (const auto& [contrast, most] : {std::pair(100.0, 8), std::pair(5.0, 3), std::pair(30.0, 1000)}) {
        const auto stiffness = test::coefficient_array(level.mesh, all, lanes, [&](std::int64_t e, int lane) {
          return pattern.stiffness(all.index(e), lane);
        });
        const auto found = fields.map.find(stiffness, lanes, contrast, most);
        for (int lane = 0; lane < lanes; ++lane) {
          SCOPED_TRACE(mask.name + ", " + pattern.name + ", lane " + std::to_string(lane));
          std::vector<double> field;
          all.for_each([&](const Index<Dim>& e, std::int64_t number) {
            field.push_back(fields.masked.whole.active[number] != 0 ? pattern.stiffness(e, lane) : 0.0);
          });
          const auto expected = test::find_serial_islands<Dim>(elements, field, supported, contrast, most);
          ASSERT_EQ(found[lane].count, expected.count);
          std::vector<int> island(level.mesh.nodes(), -1), wanted(island);
          for (const auto& node : found[lane].nodes) island[node.node] = node.island;
          fields.masked.whole.nodes.for_each([&](const Index<Dim>& node, std::int64_t offset) {
            if (!level.mesh.node_box().contains(node) || level.mesh.node_number(node) < 0) return;
            if (node[Dim - 1] > 0 && expected.count > 0)
              wanted[level.mesh.node_number(node)] = expected.node_island[offset];
          });
          ASSERT_EQ(island, wanted);
        }
      }
  }
}

}  // namespace
}  // namespace fabseq
