// SPDX-License-Identifier: MIT
/// \file
/// Memory of a run: what it has used, and what there is. Calls with a `comm` are collective on it and return
/// the same value on all of its ranks.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <optional>
#include <string>

namespace fabseq {

/// Sum over the ranks of `comm` of each rank's largest resident memory so far, bytes.
std::int64_t peak_memory_bytes(MPI_Comm comm);

/// The limit of this process's address space (ulimit -v), bytes; none: it has none. Not collective.
std::optional<std::int64_t> address_space_limit();
/// What it leaves to this process now, bytes. Not collective.
std::optional<std::int64_t> address_space_left();
/// "; the limit of the address space is 0.5 GB (ulimit -v)", empty without a limit. Not collective.
std::string address_space_words();

/// Memory built into the machines that the ranks of `comm` run on, bytes, or what limits of address space let
/// the ranks have, if that is less. Each machine counts once.
std::int64_t installed_memory_bytes(MPI_Comm comm);

/// Memory that the machines of `comm` could give to programs now, and that limits of address space leave to
/// the ranks, bytes. Each machine counts once.
std::int64_t available_memory_bytes(MPI_Comm comm);

/// Throws InputError("WHAT need at least N GB of memory; ...") on all ranks if `bytes` exceeds
/// installed_memory_bytes(). `bytes` is a lower bound of what all ranks together need. `what` starts with the
/// key that asks for it.
void require_memory(MPI_Comm comm, double bytes, const std::string& what);

}  // namespace fabseq
