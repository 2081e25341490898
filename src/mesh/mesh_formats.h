// SPDX-License-Identifier: MIT
/// \file
/// Readers of surfaces, one per format. Each returns all surfaces of a file as one mesh, joined by
/// SurfaceBuilder, and adds lines for the user to its notes. Errors are InputError and say what was found and
/// what is needed, but not in which file. Not collective.
#pragma once

#include "mesh/surface_builder.h"

#include <string>
#include <string_view>
#include <vector>

namespace fabseq {

/// Whether a file is STL by what it has in it; `by_name`: it is called so, which decides where its count of
/// triangles is wrong.
bool looks_like_stl(std::string_view file, bool by_name);
/// STL, text or binary, with the file's bytes. Text is read in double precision (round_to_single()). Bytes
/// behind the last triangle, and a count that is wrong although the surface is closed, are noted.
TriangleMesh read_stl(std::string_view file, std::vector<std::string>& notes);

/// Whether a line of a file begins as a vertex of OBJ does.
bool looks_like_obj(std::string_view file);
/// OBJ: vertices and faces, in double precision (round_to_single()). Texture coordinates, normals, materials
/// and groups count nothing, whether they are there or not.
TriangleMesh read_obj(std::string_view file);

/// PLY, text or binary: polygons of the element `face` and strips of the element `tristrips`.
TriangleMesh read_ply(std::string_view file);

/// What of a 3MF file is wanted: the bodies that are to be built, or its objects of type surface as well.
enum class ThreeMfObjects { bodies, surfaces_too };

/// 3MF, through lib3mf, which has single precision: what the build's items name, where their transformations
/// put it; sets the file's unit. A transformation that mirrors turns triangles round, so that they still face
/// outward. What is not to be part of the product is left out, with a note: what is not printable, objects
/// and components of other types, and what slicers use as modifiers, support blockers or support enforcers.
/// Their negative volumes are cut out (ObjectVolumes). Throws InputError for what is damaged or described by
/// an extension of 3MF, and, before it follows them, for components that contain themselves, or that come to
/// more than 10,000 bodies, 10 million triangles or 100 levels.
TriangleMesh read_three_mf(std::string file, ThreeMfObjects wanted, std::vector<std::string>& notes,
                           std::string& unit);

}  // namespace fabseq
