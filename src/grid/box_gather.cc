// SPDX-License-Identifier: MIT
#include "fabseq/grid/box_gather.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <array>

namespace fabseq {

namespace {

template <int Dim>
IndexBox<Dim> common_box(const IndexBox<Dim>& a, const IndexBox<Dim>& b) {
  IndexBox<Dim> common;
  for (int axis = 0; axis < Dim; ++axis) {
    common.start[axis] = std::max(a.start[axis], b.start[axis]);
    const int end = std::min(a.start[axis] + a.size[axis], b.start[axis] + b.size[axis]);
    common.size[axis] = std::max(0, end - common.start[axis]);
  }
  return common;
}

}  // namespace

template <int Dim>
BoxGather<Dim>::BoxGather(MPI_Comm comm, const IndexBox<Dim>& owned, const IndexBox<Dim>& wanted)
    : comm_(comm), owned_(owned), wanted_(wanted), own_wanted_(common_box(owned, wanted)) {
  using Boxes = std::array<IndexBox<Dim>, 2>;  // owned and wanted
  static_assert(sizeof(Boxes) == 4 * Dim * sizeof(int));
  const Boxes own{owned, wanted};
  std::vector<Boxes> all(static_cast<std::size_t>(size_of(comm)));
  MPI_Allgather(own.data(), 4 * Dim, MPI_INT, all.data(), 4 * Dim, MPI_INT, comm);
  for (int rank = 0; rank < static_cast<int>(all.size()); ++rank) {
    if (rank == rank_of(comm)) continue;
    const Neighbor neighbor{rank, common_box(owned, all[rank][1]), common_box(wanted, all[rank][0])};
    if (neighbor.sent.count() > 0 || neighbor.received.count() > 0) neighbors_.push_back(neighbor);
  }
}

FABSEQ_INSTANTIATE_CLASS(BoxGather);

}  // namespace fabseq
