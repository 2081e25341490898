// SPDX-License-Identifier: MIT
/// \file
/// Readers of surfaces, one per format. Each adds all surfaces of a regular file to a SurfaceBuilder. Errors
/// are InputError and say what was found and what is needed, but not in which file. Not collective.
#pragma once

#include "mesh/surface_builder.h"

#include <string>
#include <vector>

namespace fabseq {

/// STL or OBJ, through assimp, which has single precision. Objects stand where their transformations put
/// them.
void read_stl_or_obj(const std::string& path, SurfaceBuilder& surface);

/// PLY, text or binary: polygons of the element `face` and strips of the element `tristrips`.
void read_ply(const std::string& path, SurfaceBuilder& surface);

/// 3MF, through lib3mf, which has single precision: what the build's items name, where their transformations
/// put it. A transformation that mirrors turns triangles round, so that they still face outward. Objects that
/// are not to be part of the product (support, other) are left out. Returns a line for the user per kind of
/// object that was left out. Throws InputError, before it follows them, for components that contain
/// themselves, or that come to more than 10,000 bodies, 10 million triangles or 100 levels.
std::vector<std::string> read_three_mf(const std::string& path, SurfaceBuilder& surface);

}  // namespace fabseq
