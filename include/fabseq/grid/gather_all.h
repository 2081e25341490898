// SPDX-License-Identifier: MIT
/// \file
/// Lists of different lengths, from all ranks to all ranks.
#pragma once

#include "fabseq/base/mpi.h"

#include <cstdint>
#include <numeric>
#include <vector>

namespace fabseq {

/// The entries of all ranks, rank after rank, on every rank. Collective; at most 2^31 - 1 entries in all.
inline std::vector<std::int64_t> gather_all(MPI_Comm comm, const std::vector<std::int64_t>& own) {
  const auto ranks = static_cast<std::size_t>(size_of(comm));
  const int count = static_cast<int>(own.size());
  std::vector<int> counts(ranks), starts(ranks);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
  std::vector<std::int64_t> all(static_cast<std::size_t>(starts.back() + counts.back()));
  MPI_Allgatherv(own.data(), count, MPI_INT64_T, all.data(), counts.data(), starts.data(), MPI_INT64_T, comm);
  return all;
}

}  // namespace fabseq
