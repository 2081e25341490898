// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace fabseq {

/// An affine map: a row of the matrix and the shift along each axis.
using Placement = std::array<std::array<double, 4>, 3>;

/// The objects of a 3MF file and what its build names.
struct ThreeMfModel {
  /// An object, or the copy of one, and where it stands in the other or on the plate.
  struct Instance {
    std::size_t object = 0;  ///< index in `objects`
    Placement placement{};
  };
  struct Object {
    std::vector<Point<3>> vertices;
    std::vector<std::array<std::int64_t, 3>> triangles;
    std::vector<Instance> components;  ///< in the file's order; an object has these or triangles
  };

  std::string unit;  ///< as the file calls it
  std::vector<Object> objects;
  std::vector<Instance> items;  ///< in the file's order
};

/// Reads a 3MF archive through lib3mf, which has single precision. Throws InputError for what is damaged,
/// and, before it follows them, for components that contain themselves, or that come to more than 10,000
/// bodies, 10 million triangles or 100 levels.
ThreeMfModel read_three_mf_model(std::string& archive);

}  // namespace fabseq
