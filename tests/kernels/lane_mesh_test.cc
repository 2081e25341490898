// SPDX-License-Identifier: MIT
/// Numbering and order of lane meshes, replayed node by node on boxes with holes.
#include "kernels/lane_mesh.h"

#include "support/masked_box.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <class T>
class LaneMeshTest : public testing::Test {};
TYPED_TEST_SUITE(LaneMeshTest, test::Dimensions);

template <int Dim>
LaneMesh<Dim> mesh_of(const test::MaskedBox<Dim>& box) {
  return LaneMesh<Dim>(box.elements, box.active);
}

/// Index of each node and element of the mesh, by its number.
template <int Dim>
std::vector<Index<Dim>> nodes_by_number(const LaneMesh<Dim>& mesh) {
  std::vector<Index<Dim>> result(mesh.nodes());
  mesh.node_box().for_each([&](const Index<Dim>& node, std::int64_t) {
    if (mesh.node_number(node) >= 0) result[mesh.node_number(node)] = node;
  });
  return result;
}

TYPED_TEST(LaneMeshTest, NumbersWithoutGapsXFastest) {
  constexpr int Dim = TypeParam::value;
  for (const auto& box : test::masked_boxes<Dim>()) {
    const LaneMesh<Dim> mesh = mesh_of(box);
    std::int64_t elements = 0, nodes = 0;
    box.elements.for_each([&](const Index<Dim>& index, std::int64_t offset) {
      EXPECT_EQ(mesh.element_number(index), box.active[offset] != 0 ? elements++ : -1) << box.name;
    });
    const auto touching = box.touching_elements();
    box.nodes.for_each([&](const Index<Dim>& node, std::int64_t offset) {
      EXPECT_EQ(mesh.node_number(node), touching[offset] > 0 ? nodes++ : -1) << box.name;
    });
    EXPECT_EQ(mesh.elements(), elements);
    EXPECT_EQ(mesh.nodes(), nodes);
    EXPECT_EQ(mesh.element_box().size, box.elements.size);
    EXPECT_EQ(mesh.node_box().start, box.nodes.start);
    EXPECT_EQ(mesh.node_box().size, box.nodes.size);
  }
}

TYPED_TEST(LaneMeshTest, RowsPassEveryElementOnceWithItsCorners) {
  constexpr int Dim = TypeParam::value;
  for (const auto& box : test::masked_boxes<Dim>()) {
    const LaneMesh<Dim> mesh = mesh_of(box);
    std::vector<Index<Dim>> elements;
    box.for_each_active([&](const Index<Dim>& index, std::int64_t) { elements.push_back(index); });
    std::int64_t next = 0;
    for (const auto& row : mesh.rows()) {
      ASSERT_EQ(row.element, next) << box.name;
      ASSERT_GT(row.length, 0);
      for (int i = 0; i < row.length; ++i, ++next) {
        EXPECT_EQ(box.nodes.offset(elements[next]) / box.nodes.size[0], row.line);
        for (int corner = 0; corner < corner_count<Dim>; ++corner)
          EXPECT_EQ(row.node[corner / 2] + i + corner % 2,
                    mesh.node_number(box.corner_node(elements[next], corner)))
              << box.name;
      }
    }
    EXPECT_EQ(next, mesh.elements());
  }
}

TYPED_TEST(LaneMeshTest, RunsAreAsLongAsTheyCanBe) {
  constexpr int Dim = TypeParam::value;
  for (const auto& box : test::masked_boxes<Dim>()) {
    const LaneMesh<Dim> mesh = mesh_of(box);
    const auto nodes = nodes_by_number(mesh);
    std::int64_t next = 0;
    for (const auto& run : mesh.node_runs()) {
      ASSERT_EQ(run.node, next) << box.name;
      for (int i = 0; i < run.length; ++i, ++next) {
        Index<Dim> expected = run.index;
        expected[0] += i;
        EXPECT_EQ(nodes[next], expected);
      }
      Index<Dim> behind = run.index;
      behind[0] += run.length;
      EXPECT_EQ(box.nodes.contains(behind) ? mesh.node_number(behind) : -1, -1) << box.name;
    }
    EXPECT_EQ(next, mesh.nodes());
  }
}

/// Passes the lines as kernels do and keeps book of the window: who has the slot, and how many of its
/// elements have been added.
template <int Dim>
void replay(const test::MaskedBox<Dim>& box, const LaneMesh<Dim>& mesh,
            const std::vector<std::int64_t>& shared) {
  struct Slot {
    std::int64_t node = -1;
    int elements = 0;
  };
  std::vector<Slot> window(mesh.window());
  std::vector<int> handed_over(mesh.nodes(), 0);
  const auto nodes = nodes_by_number(mesh);
  const auto touching = box.touching_elements();
  const auto add = [&](std::int64_t node, std::int64_t slot) {
    ASSERT_TRUE(slot >= 0 && slot < mesh.window());
    EXPECT_TRUE(window[slot].node == node || window[slot].node < 0) << "two nodes in one slot";
    EXPECT_EQ(handed_over[node], 0) << "a node is needed after it was handed over";
    window[slot].node = node;
    ++window[slot].elements;
  };
  const auto hand_over = [&](std::int64_t node, std::int64_t slot, std::int64_t shared_position) {
    EXPECT_EQ(window[slot].node, node);
    EXPECT_EQ(window[slot].elements, touching[box.nodes.offset(nodes[node])]) << "incomplete";
    ++handed_over[node];
    window[slot] = {};
    const auto found = std::lower_bound(shared.begin(), shared.end(), node);
    const bool is_shared = found != shared.end() && *found == node;
    EXPECT_EQ(shared_position, is_shared ? found - shared.begin() : -1);
  };
  std::int64_t rows = 0, last_line = -1;
  for (const auto& line : mesh.lines()) {
    EXPECT_GT(line.line, last_line);
    last_line = line.line;
    EXPECT_EQ(line.first_row, rows);
    rows = line.last_row;
    for (int r = line.first_row; r < line.last_row; ++r) {
      const auto& row = mesh.rows()[r];
      EXPECT_EQ(row.line, line.line);
      for (int i = 0; i <= row.length; ++i) {
        if (i < row.length)
          for (int corner = 0; corner < corner_count<Dim>; ++corner)
            add(row.node[corner / 2] + i + corner % 2, row.slot[corner / 2] + i + corner % 2);
        if (i >= row.finish_begin && i < row.finish_end) hand_over(row.node[0] + i, row.slot[0] + i, -1);
      }
    }
    for (int s = line.first_segment; s < line.last_segment; ++s) {
      const auto& segment = mesh.segments()[s];
      for (int i = 0; i < segment.length; ++i)
        hand_over(segment.node + i, segment.slot + i, segment.shared < 0 ? -1 : segment.shared + i);
    }
  }
  EXPECT_EQ(rows, static_cast<std::int64_t>(mesh.rows().size()));
  for (const int times : handed_over) EXPECT_EQ(times, 1);
  for (const auto& slot : window) EXPECT_EQ(slot.node, -1);
}

TYPED_TEST(LaneMeshTest, EveryNodeIsHandedOverOnceAndComplete) {
  constexpr int Dim = TypeParam::value;
  for (const auto& box : test::masked_boxes<Dim>()) {
    SCOPED_TRACE(box.name);
    replay(box, mesh_of(box), {});
  }
}

TYPED_TEST(LaneMeshTest, SharedNodesAreHandedOverApart) {
  constexpr int Dim = TypeParam::value;
  for (const auto& box : test::masked_boxes<Dim>()) {
    LaneMesh<Dim> mesh = mesh_of(box);
    for (const double share : {1.0, 0.5, 0.1, 0.0}) {  // the last: as if they had never been shared
      SCOPED_TRACE(box.name + " " + std::to_string(share));
      std::vector<std::int64_t> shared;
      for (std::int64_t node = 0; node < mesh.nodes(); ++node)
        if (test::noise(node, 8) < share) shared.push_back(node);
      mesh.set_shared(shared);
      replay(box, mesh, shared);
    }
  }
}

/// A plane and two lines, and one more line for a gap, so that it stays in the cache.
TYPED_TEST(LaneMeshTest, WindowHoldsLittleMoreThanAPlane) {
  constexpr int Dim = TypeParam::value;
  for (const auto& box : test::masked_boxes<Dim>()) {
    const LaneMesh<Dim> mesh = mesh_of(box);
    const std::int64_t plane = box.nodes.count() / box.nodes.size[Dim - 1];
    const std::int64_t lines = Dim == 3 ? 3 : 2;
    EXPECT_LE(mesh.window(), plane + lines * box.nodes.size[0]) << box.name;
    if (mesh.nodes() == box.nodes.count()) {
      EXPECT_EQ(mesh.window(), plane + lines * box.nodes.size[0]) << box.name;
    }
  }
}

TYPED_TEST(LaneMeshTest, ABoxWithoutElementsIsEmpty) {
  constexpr int Dim = TypeParam::value;
  IndexBox<Dim> box;
  box.start.fill(2);
  box.size.fill(3);
  box.size[0] = 0;
  for (const LaneMesh<Dim>& mesh : {LaneMesh<Dim>(), LaneMesh<Dim>(box, {})}) {
    EXPECT_EQ(mesh.elements(), 0);
    EXPECT_EQ(mesh.nodes(), 0);
    EXPECT_EQ(mesh.window(), 0);
    EXPECT_TRUE(mesh.rows().empty() && mesh.lines().empty() && mesh.segments().empty());
  }
}

}  // namespace
}  // namespace fabseq
