// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/lanes/lane_array.h"
#include "fabseq/lanes/lane_hierarchy.h"
#include "fabseq/lanes/lane_vector.h"

#include <vector>

namespace fabseq {

/// Copies nodal values of several lanes between the grid's owned nodes and the finest level's mesh. Calls are
/// collective on the grid's communicator.
template <int Dim>
class LaneLayout {
 public:
  /// Both must outlive the layout.
  LaneLayout(const Grid<Dim>& grid, const LaneLevel<Dim>& level, int components);

  /// To [node][component][lane] with `width` lanes; lanes beyond those of `owned` become 0.
  void to_mesh(const LaneVector& owned, int width, LaneArray& mesh) const;
  /// Back; nodes that are not in the mesh become 0.
  void to_owned(const LaneArray& mesh, int width, LaneVector& owned) const;

  /// Gives back the memory that it keeps for the next call.
  void give_back_memory() const { free_memory(ghosted_); }

 private:
  const Grid<Dim>& grid_;
  const LaneLevel<Dim>& level_;
  int components_;
  std::vector<std::int64_t> places_;     ///< of each node of the mesh in the ghosted box
  mutable std::vector<double> ghosted_;  ///< kept: new memory costs more than what is done with it
};

}  // namespace fabseq
