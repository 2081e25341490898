// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/field_set.h"

#include <functional>
#include <optional>
#include <string>

namespace fabseq {

/// Where the values of a field are: the XML attributes of its data item (Format and what belongs to it), and
/// the content of the item.
struct XdmfSource {
  std::string attributes;
  std::string content;
};

/// Text of an XDMF file, by which ParaView opens the binary or HDF5 data beside it. `source(i)` gives the
/// place of the values of field i; the values themselves are not read. Not collective.
///
/// A 2D grid is described as a flat 3D one with one layer of nodes at z = 0, because 2D meshes end up in
/// ParaView's yz plane. ParaView's older "XDMF Reader" shows no element fields of such a grid; the two
/// readers that it offers first do. Vectors keep their components. Six-component tensors are six columns,
/// because XDMF's own order (xx xy xz yy yz zz) is not the Voigt order of docs/formulation.md 1. `moment`:
/// the time of the fields in a series of files, which ParaView shows as a film.
template <int Dim>
std::string xdmf_text(const FieldSet<Dim>& fields, const std::function<XdmfSource(std::size_t)>& source,
                      std::optional<double> moment = {});

}  // namespace fabseq
