// SPDX-License-Identifier: MIT
#include "files/slab_gather.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cstdint>

namespace fabseq {

template <int Dim>
SlabGather<Dim>::SlabGather(MPI_Comm comm, const Grid<Dim>& grid, const Field& field)
    : comm_(comm),
      components_(field.components),
      whole_(field.on_nodes ? grid.all_nodes() : grid.all_elements()),
      owned_(field.on_nodes ? grid.owned_nodes() : grid.owned_elements()),
      values_(field.whole(owned_.count(), room_)) {
  if (rank_of(comm_) >= size_of(grid.comm())) owned_ = {};  // this rank holds a copy
  const bool is_first = rank_of(comm_) == 0;
  if (is_first) boxes_.resize(static_cast<std::size_t>(size_of(comm_)));
  constexpr int integers = 2 * Dim;
  static_assert(sizeof(IndexBox<Dim>) == integers * sizeof(int));
  MPI_Gather(&owned_, integers, MPI_INT, boxes_.data(), integers, MPI_INT, 0, comm_);
  if (!is_first) return;
  counts_.resize(boxes_.size());
  offsets_.resize(boxes_.size());
  slab_.resize(static_cast<std::size_t>(size() / count()));
  pieces_.resize(slab_.size());
}

template <int Dim>
std::vector<hsize_t> SlabGather<Dim>::shape() const {
  std::vector<hsize_t> result(whole_.size.rbegin(), whole_.size.rend());
  if (components_ > 1) result.push_back(components_);
  return result;
}

template <int Dim>
int SlabGather<Dim>::points_in_slab(const IndexBox<Dim>& box, int slab) const {
  const int position = slab - box.start[Dim - 1];
  if (position < 0 || position >= box.size[Dim - 1]) return 0;
  return static_cast<int>(box.count() / box.size[Dim - 1]);
}

template <int Dim>
std::span<const double> SlabGather<Dim>::gather(int slab) {
  // The slowest axis is the outermost one in memory, so a rank's share of a slab is contiguous.
  const int mine = points_in_slab(owned_, slab);
  const std::int64_t first = static_cast<std::int64_t>(slab - owned_.start[Dim - 1]) * mine * components_;
  const double* piece = mine > 0 ? values_.data() + first : nullptr;

  int total = 0;
  for (std::size_t rank = 0; rank < boxes_.size(); ++rank) {
    counts_[rank] = points_in_slab(boxes_[rank], slab);
    offsets_[rank] = total;
    total += counts_[rank];
  }
  MPI_Datatype point = MPI_DATATYPE_NULL;  // the grid sees to it that an int counts a slab's
  MPI_Type_contiguous(components_, MPI_DOUBLE, &point);
  MPI_Type_commit(&point);
  MPI_Gatherv(piece, mine, point, pieces_.data(), counts_.data(), offsets_.data(), point, 0, comm_);
  MPI_Type_free(&point);
  for (std::size_t rank = 0; rank < boxes_.size(); ++rank)
    if (counts_[rank] > 0)
      place(boxes_[rank], &pieces_[static_cast<std::size_t>(offsets_[rank]) * components_]);
  return slab_;
}

template <int Dim>
void SlabGather<Dim>::place(const IndexBox<Dim>& box, const double* piece) {
  const int rows = Dim == 3 ? box.size[1] : 1;
  const int first_row = Dim == 3 ? box.start[1] : 0;
  const std::int64_t row_length = static_cast<std::int64_t>(box.size[0]) * components_;
  for (int row = 0; row < rows; ++row) {
    const std::int64_t target =
        (static_cast<std::int64_t>(first_row + row) * whole_.size[0] + box.start[0]) * components_;
    std::copy_n(piece + row * row_length, row_length, slab_.data() + target);
  }
}

FABSEQ_INSTANTIATE_CLASS(SlabGather);

}  // namespace fabseq
