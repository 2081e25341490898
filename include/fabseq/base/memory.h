// SPDX-License-Identifier: MIT
/// \file
/// Memory of a run: what it has used, and what there is. All calls are collective.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>

namespace fabseq {

/// Largest resident memory so far of all ranks of `comm` together, bytes.
std::int64_t peak_memory_bytes(MPI_Comm comm);

/// Memory built into the machines that the ranks of `comm` run on, each machine once, bytes.
std::int64_t installed_memory_bytes(MPI_Comm comm);

/// Memory that the machines of `comm` could give to programs now, each machine once, bytes.
std::int64_t available_memory_bytes(MPI_Comm comm);

/// Throws InputError("WHAT need at least N GB of memory; ..."), on all ranks, if `bytes` are more than all
/// machines of `comm` have. `bytes` is a lower bound of what all ranks together need, `what` starts with the
/// key that asks for it.
void require_memory(MPI_Comm comm, double bytes, const std::string& what);

}  // namespace fabseq
