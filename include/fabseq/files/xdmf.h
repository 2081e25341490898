// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/field_set.h"

#include <functional>
#include <string>

namespace fabseq {

/// Where the values of a field are: XML attributes of its data item (Format and what belongs to it) and its
/// content.
struct XdmfSource {
  std::string attributes;
  std::string content;
};

/// Text of an XDMF file, the small one beside binary or HDF5 data by which ParaView opens them: `source(i)`
/// is asked for each field i. Not collective, no values are read.
///
/// A 2D grid is described as a flat 3D one with one layer of nodes at z = 0: 2D meshes end up in ParaView's
/// yz plane. Its older "XDMF Reader" shows no element fields of such a grid; the two that it offers first do.
/// Vectors keep their components; six-component tensors are six columns, because XDMF's own order (xx xy xz
/// yy yz zz) is not the Voigt order of docs/formulation.md 1.
template <int Dim>
std::string xdmf_text(const FieldSet<Dim>& fields, const std::function<XdmfSource(std::size_t)>& source);

}  // namespace fabseq
