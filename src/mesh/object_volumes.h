// SPDX-License-Identifier: MIT
#pragma once

#include "mesh/surface_builder.h"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// The bodies and negative volumes of an object, in the order of its file. As slicers build it, a negative
/// volume is cut out of the bodies before it, and of no others.
class ObjectVolumes {
 public:
  /// Adds a volume: triangles between some of the vertices. Throws what SurfaceBuilder throws.
  void add(bool negative, const std::vector<Point<3>>& vertices,
           std::span<const std::array<std::int64_t, 3>> triangles);

  /// Adds what is built to a surface, and lines for the user to the notes. Throws InputError for a negative
  /// volume that cannot be cut out.
  void build(SurfaceBuilder& surface, std::vector<std::string>& notes);

 private:
  /// A negative volume, or bodies between which there is none.
  struct Volumes {
    bool negative = false;
    SurfaceBuilder surface;
  };

  /// What of the bodies is left.
  TriangleMesh cut(std::size_t bodies, const std::vector<TriangleMesh>& meshes,
                   std::vector<std::string>& notes) const;

  std::vector<Volumes> volumes_;
};

}  // namespace fabseq
