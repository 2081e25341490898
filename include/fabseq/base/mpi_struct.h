// SPDX-License-Identifier: MIT
/// \file
/// MPI datatypes, and messages of structs between ranks that run the same program on the same kind of
/// processor.
#pragma once

#include "fabseq/base/petsc.h"  // -log_view counts what is sent here

#include <mpi.h>

#include <numeric>
#include <type_traits>
#include <vector>

namespace fabseq {

/// Sole owner of a committed MPI datatype.
class MpiType {
 public:
  /// Commits `type`. Not collective.
  explicit MpiType(MPI_Datatype type) : type_(type) { MPI_Type_commit(&type_); }
  MpiType(MpiType&&) = delete;
  ~MpiType() { MPI_Type_free(&type_); }

  operator MPI_Datatype() const { return type_; }  // NOLINT(google-explicit-constructor): MPI calls take it

 private:
  MPI_Datatype type_;
};

/// `count` entries of the same type, one after the other.
inline MpiType contiguous_type(int count, MPI_Datatype entry) {
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(count, entry, &type);
  return MpiType(type);
}

/// A number, or a struct of numbers without pointers, as it lies in memory: counts are those of values, not
/// of bytes.
template <class Value>
MpiType type_in_memory() {
  static_assert(std::is_trivially_copyable_v<Value>);
  return contiguous_type(static_cast<int>(sizeof(Value)), MPI_BYTE);
}

/// Sends `outgoing[rank]` to each rank of `comm`; returns what each rank sent here, [rank]. A rank sends and
/// receives fewer than 2^31 values. Collective on `comm`.
template <class Value>
std::vector<std::vector<Value>> exchange_lists(MPI_Comm comm,
                                               const std::vector<std::vector<Value>>& outgoing) {
  const std::size_t ranks = outgoing.size();
  std::vector<int> sent, received(ranks), sent_starts(ranks), received_starts(ranks);
  std::vector<Value> packed;
  for (const auto& list : outgoing) {
    sent.push_back(static_cast<int>(list.size()));
    packed.insert(packed.end(), list.begin(), list.end());
  }
  MPI_Alltoall(sent.data(), 1, MPI_INT, received.data(), 1, MPI_INT, comm);
  std::exclusive_scan(sent.begin(), sent.end(), sent_starts.begin(), 0);
  std::exclusive_scan(received.begin(), received.end(), received_starts.begin(), 0);
  std::vector<Value> arrived(static_cast<std::size_t>(received_starts.back()) + received.back());
  const MpiType type = type_in_memory<Value>();
  MPI_Alltoallv(packed.data(), sent.data(), sent_starts.data(), type, arrived.data(), received.data(),
                received_starts.data(), type, comm);
  std::vector<std::vector<Value>> incoming;
  for (std::size_t rank = 0; rank < ranks; ++rank)
    incoming.emplace_back(arrived.begin() + received_starts[rank],
                          arrived.begin() + received_starts[rank] + received[rank]);
  return incoming;
}

}  // namespace fabseq
