/// \file
/// Field dumps during a run: one raw binary file written by all ranks through MPI-IO, and an XDMF file beside
/// it.
#pragma once

#include "fabseq/io/field_set.h"

#include <string>

namespace fabseq {

/// Writes `fields` to BASE.bin (each field whole, one after the other: little-endian doubles, lexicographic,
/// x fastest, whatever the number of ranks) by collective MPI-IO with subarray views, and BASE.xdmf, which
/// ParaView opens. Collective on the grid's communicator. Throws OutputError on all ranks if any write came
/// back short or failed, naming the file.
template <int Dim>
void write_field_dump(const FieldSet<Dim>& fields, const std::string& base);

extern template void write_field_dump<2>(const FieldSet<2>&, const std::string&);
extern template void write_field_dump<3>(const FieldSet<3>&, const std::string&);

}  // namespace fabseq
