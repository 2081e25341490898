// SPDX-License-Identifier: MIT
/// \file
/// The few MPI reductions that fabseq needs, on values and in place on arrays. All but rank_of() and
/// size_of() are collective on `comm`, and results are the same on all ranks unless they say otherwise.
#pragma once

#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// Sole owner of a communicator made by a split. All of its ranks make and free it together.
class Communicator {
 public:
  Communicator() = default;
  /// The ranks of `parent` with the same color, in the order of their keys. Collective on `parent`.
  Communicator(MPI_Comm parent, int color, int key) { MPI_Comm_split(parent, color, key, &comm_); }
  Communicator(Communicator&& other) noexcept : comm_(std::exchange(other.comm_, MPI_COMM_NULL)) {}
  Communicator& operator=(Communicator&& other) noexcept {
    std::swap(comm_, other.comm_);
    return *this;
  }
  ~Communicator() {
    if (comm_ != MPI_COMM_NULL) MPI_Comm_free(&comm_);
  }

  operator MPI_Comm() const { return comm_; }  // NOLINT(google-explicit-constructor): MPI calls take it

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
};

int rank_of(MPI_Comm comm);
int size_of(MPI_Comm comm);

/// Calls f(part) for consecutive parts of `values` of at most `most` entries each, which MPI can count; once
/// if there are none. Not collective.
template <class Value, class Function>
void for_each_message(std::span<Value> values, Function&& f, std::size_t most = std::size_t{1} << 30) {
  std::size_t begin = 0;
  do {
    const std::size_t length = std::min(most, values.size() - begin);
    f(values.subspan(begin, length));
    begin += length;
  } while (begin < values.size());
}

/// Sum, maximum or minimum of `value` over the ranks.
double sum(MPI_Comm comm, double value);
std::int64_t sum(MPI_Comm comm, std::int64_t value);
double max(MPI_Comm comm, double value);
std::int64_t max(MPI_Comm comm, std::int64_t value);
double min(MPI_Comm comm, double value);
std::int64_t min(MPI_Comm comm, std::int64_t value);
/// True on every rank if `value` is true on any rank.
bool any(MPI_Comm comm, bool value);

/// Sum over the ranks, entry by entry, in place. The length, which may be any, is the same on all ranks.
void sum_in_place(MPI_Comm comm, std::span<double> values);
void sum_in_place(MPI_Comm comm, std::span<float> values);
void sum_in_place(MPI_Comm comm, std::span<std::int64_t> values);
void sum_in_place(MPI_Comm comm, std::span<int> values);
/// Maximum over the ranks, entry by entry, in place. The length is the same on all ranks.
void max_in_place(MPI_Comm comm, std::span<double> values);

/// Returns the `text` of rank `root` on every rank.
std::string broadcast(MPI_Comm comm, const std::string& text, int root = 0);
/// Copies the `values` of rank `root` to every rank, in place. The length is the same on all ranks.
void broadcast(MPI_Comm comm, std::span<double> values, int root = 0);

/// The entries of all ranks on every rank, rank after rank. Lengths may differ between ranks. Throws
/// InputError on all ranks if there are more than 2^31 - 1 in all.
std::vector<std::int64_t> gather_all(MPI_Comm comm, std::span<const std::int64_t> own);
std::vector<double> gather_all(MPI_Comm comm, std::span<const double> own);

/// Sum of `value` over the ranks below this one, 0 on rank 0.
std::int64_t exclusive_sum(MPI_Comm comm, std::int64_t value);

}  // namespace fabseq
