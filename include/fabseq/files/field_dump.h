// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/field_set.h"

#include <optional>
#include <string>

namespace fabseq {

/// Writes `fields` to BASE.bin and BASE.xdmf. Both get their names when they are whole. BASE.bin holds each
/// field whole, one after the other, as little-endian doubles (floats for fields in single precision),
/// lexicographic, x fastest, whatever the number of ranks; it is written by collective MPI-IO with subarray
/// views. ParaView opens BASE.xdmf; files beyond 4 GiB need its older "XDMF Reader", because the newer ones
/// keep offsets in 32 bits. Collective on `comm`, whose first ranks must be those of the grid; these write,
/// and further ranks hold copies. Throws OutputError on all ranks, naming the file, if there is no room for
/// it or if any write failed or was incomplete. `moment`: the time that ParaView shows for the file in a
/// series.
template <int Dim>
void write_field_dump(MPI_Comm comm, const FieldSet<Dim>& fields, const std::string& base,
                      std::optional<double> moment = {});

}  // namespace fabseq
