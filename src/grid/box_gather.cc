// SPDX-License-Identifier: MIT
#include "fabseq/grid/box_gather.h"

#include "fabseq/base/mpi.h"

#include <array>

namespace fabseq {

template <int Dim>
BoxGather<Dim>::BoxGather(MPI_Comm comm, const IndexBox<Dim>& owned, const IndexBox<Dim>& wanted)
    : comm_(comm), wanted_(wanted), own_wanted_(owned.common_with(wanted)) {
  using Boxes = std::array<IndexBox<Dim>, 2>;  // owned and wanted
  static_assert(sizeof(Boxes) == 4 * Dim * sizeof(int));
  const Boxes own{owned, wanted};
  std::vector<Boxes> all(static_cast<std::size_t>(size_of(comm)));
  MPI_Allgather(own.data(), 4 * Dim, MPI_INT, all.data(), 4 * Dim, MPI_INT, comm);
  for (int rank = 0; rank < static_cast<int>(all.size()); ++rank) {
    if (rank == rank_of(comm)) continue;
    const Neighbor neighbor{rank, owned.common_with(all[rank][1]), wanted.common_with(all[rank][0])};
    if (neighbor.sent.count() > 0 || neighbor.received.count() > 0) neighbors_.push_back(neighbor);
  }
}

FABSEQ_INSTANTIATE_CLASS(BoxGather);

}  // namespace fabseq
