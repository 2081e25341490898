// SPDX-License-Identifier: MIT
/// \file
/// Vectors that every rank knows whole, and this rank's part of them.
#pragma once

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace fabseq::test {

/// This rank's share of a vector: contiguous and uneven, empty on the last rank where there are three or
/// more.
struct Share {
  Share(MPI_Comm comm, std::size_t count) {
    const int ranks = size_of(comm) > 2 ? size_of(comm) - 1 : size_of(comm);
    const int rank = rank_of(comm);
    begin = std::min(count, count * rank / ranks);
    end = rank >= ranks ? begin : count * (rank + 1) / ranks;
  }
  std::vector<double> of(const std::vector<double>& whole) const {
    return {whole.begin() + static_cast<std::ptrdiff_t>(begin),
            whole.begin() + static_cast<std::ptrdiff_t>(end)};
  }
  std::size_t size() const { return end - begin; }
  std::size_t begin = 0, end = 0;
};

inline std::vector<double> whole_vector(MPI_Comm comm, const Share& share, const std::vector<double>& local,
                                        std::size_t count) {
  std::vector<double> whole(count, 0.0);
  std::copy(local.begin(), local.end(), whole.begin() + static_cast<std::ptrdiff_t>(share.begin));
  sum_in_place(comm, whole);
  return whole;
}

}  // namespace fabseq::test
