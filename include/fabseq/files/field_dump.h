// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/field_set.h"

#include <string>

namespace fabseq {

/// Writes `fields` to BASE.bin (each field whole, one after the other: little-endian doubles, or floats for
/// fields in single precision, lexicographic, x fastest, whatever the number of ranks) by collective MPI-IO
/// with subarray views, and BASE.xdmf, which ParaView opens (beyond 4 GiB only with its older "XDMF Reader":
/// the newer ones keep offsets in 32 bits). Both appear under their names when they are whole. Collective on
/// `comm`, whose first ranks must be those of the grid and write; further ranks hold copies. Throws
/// OutputError on all ranks, naming the file, if there is no room for it or any write came back short or
/// failed.
template <int Dim>
void write_field_dump(MPI_Comm comm, const FieldSet<Dim>& fields, const std::string& base);

}  // namespace fabseq
