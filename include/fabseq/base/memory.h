// SPDX-License-Identifier: MIT
/// \file
/// Memory of a run: what it has used, and what there is. All calls are collective on `comm` and return the
/// same value on all of its ranks.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>

namespace fabseq {

/// Sum over the ranks of `comm` of each rank's largest resident memory so far, bytes.
std::int64_t peak_memory_bytes(MPI_Comm comm);

/// Memory built into the machines that the ranks of `comm` run on, bytes. Each machine counts once.
std::int64_t installed_memory_bytes(MPI_Comm comm);

/// Memory that the machines of `comm` could give to programs now, bytes. Each machine counts once.
std::int64_t available_memory_bytes(MPI_Comm comm);

/// Throws InputError("WHAT need at least N GB of memory; ...") on all ranks if `bytes` exceeds
/// installed_memory_bytes(). `bytes` is a lower bound of what all ranks together need. `what` starts with the
/// key that asks for it.
void require_memory(MPI_Comm comm, double bytes, const std::string& what);

}  // namespace fabseq
