// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fabseq {

/// The elements and supports of a system with `components` unknowns per node.
struct SystemDomain {
  int components = 1;
  std::vector<int> first_corners;  ///< offset in the ghosted node box of each owned element of the model
  std::vector<char> fixed;         ///< 1 where the value is prescribed, [owned node][component]
};

/// Numbers the free nodes of the model consecutively, rank by rank, for PETSc's matrices. Nodes that touch no
/// element of the model, or of which every component is fixed, are no unknowns. Construction is collective.
template <int Dim>
class UnknownNumbering {
 public:
  UnknownNumbering(const Grid<Dim>& grid, const SystemDomain& domain);

  const Grid<Dim>& grid() const { return grid_; }
  int components() const { return components_; }
  /// Unknown nodes of this rank, as offsets in Grid::owned_nodes(), ascending.
  const std::vector<int>& owned_nodes() const { return owned_nodes_; }
  /// Number of the first of them, and of unknown nodes on all ranks.
  std::int64_t first() const { return first_; }
  std::int64_t count() const { return count_; }
  /// Number of each node of the ghosted box, -1 where it is no unknown.
  const std::vector<PetscInt>& numbers() const { return numbers_; }
  /// Fixed components of nodes that are unknowns nevertheless: their rows (number * components + component),
  /// this rank's.
  const std::vector<PetscInt>& fixed_rows() const { return fixed_rows_; }

 private:
  const Grid<Dim>& grid_;
  int components_;
  std::vector<int> owned_nodes_;
  std::int64_t first_ = 0, count_ = 0;
  std::vector<PetscInt> numbers_, fixed_rows_;
};

}  // namespace fabseq
