// SPDX-License-Identifier: MIT
#include "mesh/mesh_pieces.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

namespace {

/// An edge of a triangle.
struct TriangleEdge {
  std::uint64_t points;  ///< lower point, higher point
  std::int32_t triangle;
  bool downwards;  ///< runs from the higher point to the lower one
};

/// The edges of all triangles, those between the same points together, in the order of the triangles.
std::vector<TriangleEdge> sorted_edges(const TriangleMesh& mesh) {
  std::vector<TriangleEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const auto from = static_cast<std::uint64_t>(mesh.triangles[t][i]);
      const auto to = static_cast<std::uint64_t>(mesh.triangles[t][(i + 1) % 3]);
      edges.push_back(
          {std::min(from, to) << 32 | std::max(from, to), static_cast<std::int32_t>(t), from > to});
    }
  std::sort(edges.begin(), edges.end(), [](const TriangleEdge& a, const TriangleEdge& b) {
    return a.points != b.points ? a.points < b.points : a.triangle < b.triangle;
  });
  return edges;
}

/// Sets of triangles, each known by one of its members.
class TriangleSets {
 public:
  explicit TriangleSets(std::size_t count) : above_(count) { std::iota(above_.begin(), above_.end(), 0); }

  std::int32_t find(std::int32_t triangle) {
    while (above_[triangle] != triangle) {
      above_[triangle] = above_[above_[triangle]];
      triangle = above_[triangle];
    }
    return triangle;
  }
  /// The lower one names both, so that the name of a set is its first triangle.
  void unite(std::int32_t a, std::int32_t b) {
    const auto [low, high] = std::minmax({find(a), find(b)});
    above_[high] = low;
  }

 private:
  std::vector<std::int32_t> above_;
};

/// Unites triangles across their edges. Returns those that have an edge without a partner.
std::vector<std::int32_t> unite_across_edges(const TriangleMesh& mesh, TriangleSets& sets) {
  std::vector<std::int32_t> alone;
  std::vector<TriangleEdge> waiting;  // all of one direction
  const std::vector<TriangleEdge> edges = sorted_edges(mesh);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (waiting.empty() || waiting.back().downwards == edges[e].downwards) {
      waiting.push_back(edges[e]);
    } else {
      sets.unite(waiting.back().triangle, edges[e].triangle);
      waiting.pop_back();
    }
    if (e + 1 < edges.size() && edges[e + 1].points == edges[e].points) continue;
    for (const TriangleEdge& edge : waiting) alone.push_back(edge.triangle);
    waiting.clear();
  }
  return alone;
}

}  // namespace

std::vector<MeshPiece> find_mesh_pieces(const TriangleMesh& mesh) {
  TriangleSets sets(mesh.triangles.size());
  const std::vector<std::int32_t> alone = unite_across_edges(mesh, sets);
  std::vector<MeshPiece> pieces;
  std::vector<std::int32_t> number(mesh.triangles.size());  // of the piece, at its first triangle
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t) {
    const std::int32_t first = sets.find(t);
    if (first == t) {
      number[t] = static_cast<std::int32_t>(pieces.size());
      pieces.emplace_back();
    }
    pieces[number[first]].triangles.push_back(t);
  }
  for (const std::int32_t triangle : alone) pieces[number[sets.find(triangle)]].closed = false;
  return pieces;
}

}  // namespace fabseq
