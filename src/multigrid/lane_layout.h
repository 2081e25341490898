// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/kernels/lane_vector.h"
#include "kernels/lane_array.h"
#include "multigrid/lane_hierarchy.h"

#include <vector>

namespace fabseq {

/// Copies nodal values of several lanes between the grid's owned nodes and the finest level's mesh. Calls are
/// collective on the grid's communicator.
template <int Dim>
class LaneLayout {
 public:
  /// The grid must outlive the layout.
  LaneLayout(const Grid<Dim>& grid, const LaneLevel<Dim>& level, int components);

  /// Copies to [node][component][lane] with `width` lanes; lanes beyond those of `owned` become 0.
  void to_mesh(const LaneVector& owned, int width, LaneArray& mesh) const;
  /// Back; nodes that are not in the mesh become 0.
  void to_owned(const LaneArray& mesh, int width, LaneVector& owned) const;

  /// Gives back the memory that it keeps for the next call.
  void release_memory() const { free_memory(ghosted_); }

 private:
  /// Nodes that follow each other in the mesh and in the ghosted box.
  struct Piece {
    std::int64_t node = 0;   ///< number of the first in the mesh
    std::int64_t place = 0;  ///< its offset in the ghosted box
    std::int64_t length = 0;
    bool counted = false;  ///< LaneLevel::counted
  };

  const Grid<Dim>& grid_;
  int components_;
  bool alone_;  ///< one rank has the whole grid: owned and ghosted nodes are the same
  std::size_t mesh_nodes_;
  std::vector<Piece> pieces_;            ///< ascending
  mutable std::vector<double> ghosted_;  ///< kept: new memory costs more than what is done with it
};

}  // namespace fabseq
