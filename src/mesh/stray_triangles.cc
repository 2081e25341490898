// SPDX-License-Identifier: MIT
#include "mesh/stray_triangles.h"

#include "fabseq/base/formatted.h"
#include "mesh/mesh_pieces.h"

#include <algorithm>

namespace fabseq {

namespace {

constexpr std::size_t most_triangles_of_stray = 8;
constexpr double much_larger = 10.0;

bool may_be_stray(const MeshPiece& piece) {
  return !piece.closed && piece.triangles.size() <= most_triangles_of_stray;
}

/// The box around all that cannot be stray.
Bounds bounds_of_rest(const TriangleMesh& mesh, const std::vector<MeshPiece>& pieces) {
  Bounds rest = bounds(mesh, {});
  for (const MeshPiece& piece : pieces)
    if (!may_be_stray(piece)) rest = join(rest, bounds(mesh, piece.triangles));
  return rest;
}

void remove_triangles(TriangleMesh& mesh, const std::vector<char>& removed) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (removed[t] == 0) mesh.triangles[kept++] = mesh.triangles[t];
  mesh.triangles.resize(kept);
}

}  // namespace

std::vector<std::string> remove_stray_triangles(TriangleMesh& mesh) {
  const std::vector<MeshPiece> pieces = find_mesh_pieces(mesh);
  const Bounds rest = bounds_of_rest(mesh, pieces);
  const double volume_of_rest = volume(rest);
  if (!(volume_of_rest > 0.0)) return {};
  std::vector<char> removed(mesh.triangles.size(), 0);
  std::size_t count = 0;
  double largest = 0.0;
  Point<3> place{};
  for (const MeshPiece& piece : pieces) {
    if (!may_be_stray(piece)) continue;
    const Bounds box = bounds(mesh, piece.triangles);
    const bool has_area = box.low[0] <= box.high[0];
    const double larger = has_area ? volume(join(rest, box)) / volume_of_rest : 1.0;
    if (has_area && larger < much_larger) continue;
    for (const std::int32_t t : piece.triangles) removed[t] = 1;
    if (!has_area) continue;
    count += piece.triangles.size();
    if (larger <= largest) continue;
    largest = larger;
    place = mesh.corners(static_cast<std::size_t>(piece.triangles.front()))[0];
  }
  remove_triangles(mesh, removed);
  if (count == 0) return {};
  return {std::to_string(count) + (count == 1 ? " stray triangle at " : " stray triangles, one at ") +
          to_text<3>(place) +
          formatted(" in the file, would make the box %.3g times as large: left out", largest)};
}

}  // namespace fabseq
