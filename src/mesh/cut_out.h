// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mesh/triangle_mesh.h"

namespace fabseq {

/// The surface of a body without what lies inside another surface. The body may be open, cut itself or
/// consist of several pieces; inside the hole is where its winding number is 1/2 or more in modulus. The
/// result winds around a point outside the hole as often as `body` does (rounded), and around no point inside
/// it.
///
/// Triangles are divided along the lines in which the surfaces meet. Of their pieces those of the body
/// outside the hole stay, and those of the hole in the body, turned round, as often as the body winds around
/// them. Two closed surfaces make a closed one, up to pieces as thin as 1e-9 of the whole. Faces may lie on
/// each other.
///
/// Throws InputError if samples of the result contradict the two surfaces, as for a hole that cuts itself.
TriangleMesh cut_out(const TriangleMesh& body, const TriangleMesh& hole);

}  // namespace fabseq
