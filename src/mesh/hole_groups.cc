// SPDX-License-Identifier: MIT
#include "mesh/hole_groups.h"

#include "mesh/mesh_pieces.h"

#include <algorithm>
#include <utility>

namespace fabseq {

namespace {

TriangleMesh piece_of(const TriangleMesh& mesh, const MeshPiece& piece) {
  TriangleMesh result;
  std::vector<std::int32_t> numbers(mesh.points.size(), -1);
  for (const std::int32_t t : piece.triangles) {
    auto& triangle = result.triangles.emplace_back();
    for (int i = 0; i < 3; ++i) {
      const std::int32_t point = mesh.triangles[t][i];
      if (numbers[point] < 0) {
        numbers[point] = static_cast<std::int32_t>(result.points.size());
        result.points.push_back(mesh.points[point]);
      }
      triangle[i] = numbers[point];
    }
  }
  return result;
}

/// The closed pieces of a mesh, or the whole.
std::vector<TriangleMesh> separated(const TriangleMesh& mesh) {
  std::vector<TriangleMesh> result;
  for (const MeshPiece& piece : find_mesh_pieces(mesh)) {
    result.push_back(piece_of(mesh, piece));
    if (!piece.closed || signed_volume(result.back()) < 0.0) return {mesh};
  }
  return result;
}

struct Group {
  std::vector<Bounds> boxes;
  TriangleMesh mesh;

  bool takes(const Bounds& box) const {
    return std::none_of(boxes.begin(), boxes.end(), [&](const Bounds& other) { return overlap(other, box); });
  }
  void add(const TriangleMesh& other, const Bounds& box) {
    boxes.push_back(box);
    const auto first = static_cast<std::int32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
    for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  }
};

}  // namespace

std::vector<TriangleMesh> hole_groups(const std::vector<TriangleMesh>& meshes) {
  std::vector<Group> groups;
  for (const TriangleMesh& mesh : meshes)
    for (const TriangleMesh& piece : separated(mesh)) {
      const Bounds box = bounds(piece);
      auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.takes(box); });
      if (group == groups.end()) group = groups.insert(group, Group{});
      group->add(piece, box);
    }
  std::vector<TriangleMesh> result;
  for (Group& group : groups) result.push_back(std::move(group.mesh));
  return result;
}

}  // namespace fabseq
