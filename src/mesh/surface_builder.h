// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fabseq {

/// Joins the surfaces of a file into one mesh, whatever the format. Points at equal positions become one.
/// Polygons are divided into fans: where one is not convex, triangles overlap, and the winding number, which
/// sees their orientation, is still that of the polygon. Triangles in which all points differ stay even if
/// their area is 0, since a surface may be open without them; others do not count, nor do unused vertices.
///
/// Errors are InputError and say what was found and what is needed, but not in which file. Not collective.
class SurfaceBuilder {
 public:
  SurfaceBuilder();

  /// Begins a surface with vertices of its own, to which the polygons that follow refer.
  void begin(std::vector<Point<3>> vertices);
  /// Adds a polygon of the surface. Throws InputError if a corner is no index of a vertex, if a coordinate is
  /// beyond largest_mesh_coordinate, or if there are more than 2^31 - 1 triangles.
  void add_polygon(std::span<const std::int64_t> corners);
  bool empty() const { return mesh_.triangles.empty(); }
  /// What was added. Throws InputError if there is no triangle.
  TriangleMesh take();

 private:
  std::int32_t number_of_vertex(std::int64_t vertex);
  std::int32_t number_of_point(const Point<3>& point);
  std::int32_t& slot_of(const Point<3>& point);
  void grow();

  TriangleMesh mesh_;
  std::vector<Point<3>> vertices_;     ///< of the surface in hand
  std::vector<std::int32_t> numbers_;  ///< of its vertices in the mesh, or `none`
  std::int64_t polygons_ = 0;          ///< of the surface in hand
  std::vector<std::int32_t> slots_;    ///< hash table of the mesh's points
};

}  // namespace fabseq
