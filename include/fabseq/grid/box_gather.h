// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/mpi_struct.h"
#include "fabseq/grid/index_box.h"

#include <mpi.h>

#include <cstddef>
#include <vector>

namespace fabseq {

/// Copies values of a field of elements (or nodes) from the ranks that own them to those that ask for them.
/// Every rank owns a box and wants a box; the owned boxes do not overlap. What nobody owns, such as what lies
/// outside the grid, is left at a value of the caller's. Construction and gather() are collective on `comm`.
/// A rank holds and sends no more than its two boxes, and 16 or 24 numbers for each rank of `comm`.
template <int Dim>
class BoxGather {
 public:
  BoxGather(MPI_Comm comm, const IndexBox<Dim>& owned, const IndexBox<Dim>& wanted);

  const IndexBox<Dim>& wanted() const { return wanted_; }

  /// Returns the field on wanted(), lexicographic. `source(index)` is the value at an owned index: a
  /// number, or a struct of numbers without pointers. `elsewhere`: the value of what nobody owns.
  template <class Value, class Source>
  std::vector<Value> gather(Source&& source, const Value& elsewhere = {}) const;
  /// The same without what this rank owns: changes only what others own in `field`, which is on wanted().
  template <class Value, class Source>
  void gather_others(Source&& source, std::vector<Value>& field) const {
    exchange(source, field, [] {});
  }

 private:
  /// What two ranks have to send to each other; the boxes may be empty.
  struct Neighbor {
    int rank = 0;
    IndexBox<Dim> sent, received;
  };

  /// `meanwhile`: to do while messages are under way.
  template <class Value, class Source, class Meanwhile>
  void exchange(Source&& source, std::vector<Value>& field, Meanwhile&& meanwhile) const;

  MPI_Comm comm_;
  IndexBox<Dim> wanted_, own_wanted_;  ///< the second: what this rank owns of what it wants
  std::vector<Neighbor> neighbors_;
};

template <int Dim>
template <class Value, class Source>
std::vector<Value> BoxGather<Dim>::gather(Source&& source, const Value& elsewhere) const {
  std::vector<Value> result(static_cast<std::size_t>(wanted_.count()), elsewhere);
  exchange(source, result, [&] {
    own_wanted_.for_each(
        [&](const Index<Dim>& index, std::int64_t) { result[wanted_.offset(index)] = source(index); });
  });
  return result;
}

template <int Dim>
template <class Value, class Source, class Meanwhile>
void BoxGather<Dim>::exchange(Source&& source, std::vector<Value>& field, Meanwhile&& meanwhile) const {
  const MpiType type = type_in_memory<Value>();
  std::vector<std::vector<Value>> incoming(neighbors_.size()), outgoing(neighbors_.size());
  std::vector<MPI_Request> requests;
  for (std::size_t n = 0; n < neighbors_.size(); ++n) {
    const IndexBox<Dim>& box = neighbors_[n].received;
    if (box.count() == 0) continue;
    incoming[n].resize(static_cast<std::size_t>(box.count()));
    MPI_Irecv(incoming[n].data(), static_cast<int>(box.count()), type, neighbors_[n].rank, 0, comm_,
              &requests.emplace_back());
  }
  for (std::size_t n = 0; n < neighbors_.size(); ++n) {
    const IndexBox<Dim>& box = neighbors_[n].sent;
    if (box.count() == 0) continue;
    outgoing[n].reserve(static_cast<std::size_t>(box.count()));
    box.for_each([&](const Index<Dim>& index, std::int64_t) { outgoing[n].push_back(source(index)); });
    MPI_Isend(outgoing[n].data(), static_cast<int>(box.count()), type, neighbors_[n].rank, 0, comm_,
              &requests.emplace_back());
  }
  meanwhile();
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  for (std::size_t n = 0; n < neighbors_.size(); ++n)
    neighbors_[n].received.for_each([&](const Index<Dim>& index, std::int64_t offset) {
      field[wanted_.offset(index)] = incoming[n][offset];
    });
}

}  // namespace fabseq
