// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <cstdint>
#include <vector>

namespace fabseq {

/// The elements of the model and the prescribed values of a linear system with `components` unknowns per
/// node.
struct SystemDomain {
  int components = 1;
  /// For each owned element of the model, the offset of its lowest node in the ghosted node box.
  std::vector<int> first_corners;
  std::vector<char> fixed;  ///< [owned node][component]: 1 if the value is prescribed
};

/// Numbers the free nodes of the model consecutively, rank by rank, for PETSc's matrices. Nodes that touch no
/// element of the model, or all of whose components are fixed, are no unknowns. Construction is collective on
/// the grid's communicator. The grid must outlive the object.
template <int Dim>
class UnknownNumbering {
 public:
  UnknownNumbering(const Grid<Dim>& grid, const SystemDomain& domain);

  const Grid<Dim>& grid() const { return grid_; }
  int components() const { return components_; }
  /// Unknown nodes of this rank as offsets in Grid::owned_nodes(), ascending.
  const std::vector<int>& owned_nodes() const { return owned_nodes_; }
  /// Number of this rank's first unknown node, and the count of unknown nodes of all ranks.
  std::int64_t first() const { return first_; }
  std::int64_t count() const { return count_; }
  /// Number of each node of the ghosted box; -1 for nodes that are no unknowns.
  const std::vector<PetscInt>& numbers() const { return numbers_; }
  /// This rank's matrix rows (number * components + component) of the fixed components of unknown nodes.
  const std::vector<PetscInt>& fixed_rows() const { return fixed_rows_; }

 private:
  const Grid<Dim>& grid_;
  int components_;
  std::vector<int> owned_nodes_;
  std::int64_t first_ = 0, count_ = 0;
  std::vector<PetscInt> numbers_, fixed_rows_;
};

}  // namespace fabseq
