// SPDX-License-Identifier: MIT
/// \file
/// Parts, shapes and node sets as a config has them.
#pragma once

#include "fabseq/keys/section.h"
#include "fabseq/part/node_set.h"

#include <string>

namespace fabseq {

/// Section "part": a shape or voxels.
Section<PartDescription> part_keys();
/// Section "part.mesh".
Section<MeshFile> mesh_keys();
/// Section "node_sets.NAME": a shape, and which of its nodes belong to the set.
Section<NodeSetDescription> node_set_keys();
/// The sections of all shapes, "shape" and "shape.*".
std::vector<SectionKeys> shape_declarations();

/// The shape in a completed config object, which may have other keys beside the shape's. Throws InputError
/// for empty boxes, cylinders without length and normals of length 0.
Shape make_shape(const Json& value, const KeyPlace& place);
/// Brings an object that make_shape() reads to another shape; its other keys stay.
void write_shape(const Shape& shape, Json& object);
/// The plate on the face of that name; "z-" is the lower end of the z axis.
BuildPlate make_plate(const std::string& face);

}  // namespace fabseq
