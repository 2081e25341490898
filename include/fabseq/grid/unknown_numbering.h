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
  /// Offset of the lowest node of each owned element of the model in the ghosted node box.
  std::vector<int> first_corners;
  std::vector<char> fixed;  ///< [owned node][component]: 1 if the value is prescribed
};

/// Numbers the free nodes of the model consecutively, rank by rank, for PETSc's matrices. Nodes that touch no
/// element of the model, or all of whose components are fixed, are no unknowns. Construction is collective on
/// the grid's communicator. The grid must outlive the object.
template <int Dim>
struct UnknownNumbering {
  UnknownNumbering(const Grid<Dim>& grid_, const SystemDomain& domain);

  const Grid<Dim>& grid;
  int components;
  std::vector<int> owned_nodes;   ///< unknown nodes of this rank: offsets in Grid::owned_nodes(), ascending
  std::int64_t first = 0;         ///< number of this rank's first unknown node
  std::int64_t count = 0;         ///< number of unknown nodes of all ranks
  std::vector<PetscInt> numbers;  ///< of each node of the ghosted box; -1 for nodes that are no unknowns
  /// This rank's matrix rows (number * components + component) of the fixed components of unknown nodes.
  std::vector<PetscInt> fixed_rows;
};

}  // namespace fabseq
