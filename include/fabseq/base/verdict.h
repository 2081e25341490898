// SPDX-License-Identifier: MIT
/// \file
/// Work that may fail on one rank, with an outcome that all ranks know.
#pragma once

#include <mpi.h>

#include <functional>

namespace fabseq {

/// Runs `work` on every rank of `comm` and waits for all of them. If it throws on any rank, the error of the
/// lowest such rank is thrown on all: an Error keeps its type, any other exception becomes an OutputError
/// with its text. `work` must not contain collective calls in which ranks would wait for one that has failed.
/// Collective on `comm`.
void run_on_all(MPI_Comm comm, const std::function<void()>& work);

/// The same for work of rank 0 alone; the others wait for the outcome. Collective on `comm`.
void run_on_first(MPI_Comm comm, const std::function<void()>& work);

/// The same for work that is collective on each of several groups of ranks and fails on all ranks of a group
/// or on none. `across` holds one rank of each group. With one group this runs `work` and nothing else.
/// Collective on `across`.
void run_in_groups(MPI_Comm across, const std::function<void()>& work);

}  // namespace fabseq
