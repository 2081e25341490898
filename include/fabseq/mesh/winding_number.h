// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fabseq {

struct NormalMoments;

/// How often triangles wind around a point (Jacobson et al. 2013): the solid angle under which the point sees
/// them, over 4 pi. For a closed mesh this is an integer off the surface, 0 outside; for one with holes it
/// changes smoothly where the surface is missing.
///
/// A binary tree over the triangles makes it fast (Barill et al. 2018): triangles far away act through the
/// moments of their normals, those close by through their solid angles. The largest error found is 0.008, in
/// some 10^6 points near spheres of 10^3 to 2 10^6 triangles; random triangles and a torus have 0.006
/// (tests/mesh/winding_number_test.cc).
class WindingNumber {
 public:
  /// Builds the tree, in O(n log n), with 42 bytes per triangle, for a while 16 more. Keeps a reference to
  /// the mesh's points.
  explicit WindingNumber(const TriangleMesh& mesh);

  /// Most points that one call of at() takes.
  static constexpr std::size_t group_limit = 64;
  /// The winding numbers around points which are at most `radius` away from `center`; `values` has one entry
  /// per point. They share one walk through the tree, several times as fast as a walk for each. A value
  /// depends on its point, on `center` and on `radius`, but not on the other points.
  void at(std::span<const Point<3>> points, const Point<3>& center, double radius,
          std::span<double> values) const;

 private:
  /// The triangles from `begin` to `end`. The first child follows its parent; `second_child` is 0 in leaves.
  struct Node {
    Point<3> center;  ///< about which the moments are
    float reach;      ///< distance from `center` from which on the moments will do
    std::array<float, 3> normal;
    std::array<float, 6> first;    ///< of the harmonic part, with the factor -3 of the expansion
    std::array<float, 10> second;  ///< likewise, 15/2
    std::int32_t second_child, begin, end;
  };
  /// A triangle while the tree is built: single precision is enough to divide them.
  struct Item {
    std::array<float, 3> centroid;
    std::int32_t triangle;
  };
  struct Group;

  NormalMoments build(const TriangleMesh& mesh, std::span<Item> items);
  void fill(Node& node, NormalMoments moments) const;
  void walk(const Point<3>& center, double radius, Group& group) const;

  const std::vector<Point<3>>& points_;
  std::vector<std::array<std::int32_t, 3>> triangles_;  ///< in the order of the leaves
  std::vector<Node> nodes_;                             ///< depth first
};

}  // namespace fabseq
