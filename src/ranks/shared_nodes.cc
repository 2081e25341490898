// SPDX-License-Identifier: MIT
#include "ranks/shared_nodes.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/petsc.h"  // -log_view counts what is sent here

#include <algorithm>
#include <map>
#include <utility>

namespace fabseq {

template <int Dim>
SharedNodes::SharedNodes(MPI_Comm comm, const LaneMesh<Dim>& mesh) : comm_(comm), rank_(rank_of(comm)) {
  std::map<std::int64_t, int> lowest_holder;
  std::vector<IndexBox<Dim>> boxes(static_cast<std::size_t>(size_of(comm)));
  static_assert(sizeof(IndexBox<Dim>) == 2 * Dim * sizeof(int));
  MPI_Allgather(&mesh.node_box(), 2 * Dim, MPI_INT, boxes.data(), 2 * Dim, MPI_INT, comm);
  for (int rank = 0; rank < static_cast<int>(boxes.size()); ++rank) {
    const IndexBox<Dim> common = mesh.node_box().common_with(boxes[rank]);
    if (rank == rank_ || common.count() == 0) continue;
    std::vector<char> own(static_cast<std::size_t>(common.count())), theirs(own.size());
    common.for_each([&](const Index<Dim>& node, std::int64_t offset) {
      own[offset] = mesh.node_number(node) >= 0 ? 1 : 0;
    });
    MPI_Sendrecv(own.data(), static_cast<int>(own.size()), MPI_CHAR, rank, 0, theirs.data(),
                 static_cast<int>(theirs.size()), MPI_CHAR, rank, 0, comm, MPI_STATUS_IGNORE);
    Peer neighbor{rank, {}};
    common.for_each([&](const Index<Dim>& node, std::int64_t offset) {
      if (own[offset] == 0 || theirs[offset] == 0) return;
      const std::int64_t number = mesh.node_number(node);
      neighbor.numbers.push_back(number);
      lowest_holder.try_emplace(number, std::min(rank, rank_));
    });
    if (!neighbor.numbers.empty()) neighbors_.push_back(std::move(neighbor));
  }
  for (const auto& [node, holder] : lowest_holder) {
    nodes_.push_back(node);
    counted_.push_back(holder == rank_ ? 1 : 0);
  }
  for (Peer& neighbor : neighbors_)
    for (std::int64_t& number : neighbor.numbers)
      number = std::lower_bound(nodes_.begin(), nodes_.end(), number) - nodes_.begin();
}

template <class Real>
void SharedNodes::sum(std::span<Real> values, int entries) {
  if (neighbors_.empty()) return;
  auto& [buffers, own] = std::get<Buffers<Real>>(buffers_);
  exchange(comm_, neighbors_, neighbors_, values.data(), entries, buffers);
  // In the order of ranks on every holder: the same bits everywhere.
  own.assign(values.begin(), values.end());
  std::fill(values.begin(), values.end(), Real{0});
  bool own_added = false;
  const auto add_own = [&values, &own = own, &own_added] {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += own[i];
    own_added = true;
  };
  for (std::size_t n = 0; n < neighbors_.size(); ++n) {
    if (!own_added && neighbors_[n].rank > rank_) add_own();
    const Real* value = buffers.incoming[n].values.data();
    for (const std::int64_t position : neighbors_[n].numbers)
      for (int entry = 0; entry < entries; ++entry) values[position * entries + entry] += *value++;
  }
  if (!own_added) add_own();
}

template SharedNodes::SharedNodes(MPI_Comm, const LaneMesh<2>&);
template SharedNodes::SharedNodes(MPI_Comm, const LaneMesh<3>&);
template void SharedNodes::sum(std::span<double>, int);
template void SharedNodes::sum(std::span<float>, int);

}  // namespace fabseq
