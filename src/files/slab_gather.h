// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/field_set.h"

#include <hdf5.h>
#include <mpi.h>

#include <span>
#include <vector>

namespace fabseq {

/// Gathers a field on rank 0, one slab at a time, so that it fits the rank's memory. A slab is one index of
/// the slowest axis. Construction and gather() are collective on `comm`, whose first ranks must be those of
/// the grid. Further ranks may hold copies of the field, which are not sent. Field values must outlive the
/// object.
template <int Dim>
class SlabGather {
 public:
  using Field = typename FieldSet<Dim>::Field;

  SlabGather(MPI_Comm comm, const Grid<Dim>& grid, const Field& field);

  /// Number of slabs: the extent of the slowest axis.
  int count() const { return whole_.size[Dim - 1]; }
  /// Extents of the field in a file, slowest axis first: [z][y][x], and [component] if there are several.
  std::vector<hsize_t> shape() const;
  /// Number of values of the whole field.
  std::int64_t size() const { return whole_.count() * components_; }
  /// Values of a slab on rank 0, [y][x][component], valid until the next call; an empty span on other ranks.
  std::span<const double> gather(int slab);

 private:
  /// Number of elements or nodes that a box contributes to a slab.
  int points_in_slab(const IndexBox<Dim>& box, int slab) const;
  void place(const IndexBox<Dim>& box, const double* piece);

  MPI_Comm comm_;
  int components_;
  IndexBox<Dim> whole_, owned_;
  std::vector<double> room_;  ///< of a field that has values on some entities only
  std::span<const double> values_;
  // Rank 0 only:
  std::vector<IndexBox<Dim>> boxes_;  ///< owned box of each rank, empty for copies
  std::vector<int> counts_, offsets_;
  std::vector<double> pieces_, slab_;
};

}  // namespace fabseq
