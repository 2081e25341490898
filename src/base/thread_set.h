// SPDX-License-Identifier: MIT
#pragma once

#include <mpi.h>

#include <array>
#include <climits>
#include <cstddef>
#include <span>

namespace fabseq {

/// Hardware threads of a machine, by the numbers that Linux gives them.
class ThreadSet {
 public:
  static constexpr int most = 8192;  ///< Linux is built for no more

  bool has(int thread) const;
  /// A number out of range is left out.
  void add(int thread);
  int count() const;
  /// Takes in what the other ranks of `comm` have, which run on this machine, too. Collective.
  void unite(MPI_Comm comm);
  /// A bit for each number, lowest first.
  std::span<const unsigned long> words() const { return words_; }

 private:
  static constexpr int bits = sizeof(unsigned long) * CHAR_BIT;
  std::array<unsigned long, most / bits> words_{};
};

/// The threads that this process may run on: the machine's without those that a launcher, a batch system or
/// a container keeps from it. All that are online where the system does not say. Not collective.
ThreadSet threads_of_process();

}  // namespace fabseq
