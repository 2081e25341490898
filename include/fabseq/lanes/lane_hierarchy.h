// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/lanes/lane_mesh.h"
#include "fabseq/lanes/lane_transfer.h"
#include "fabseq/lanes/shared_nodes.h"

#include <cstdint>
#include <deque>
#include <vector>

namespace fabseq {

/// One level of the lane multigrid, common to all lanes. It is either distributed like the grid or
/// agglomerated: held whole by every rank.
template <int Dim>
struct LaneLevel {
  /// Nodes begin ... end - 1.
  struct Range {
    std::int64_t begin = 0, end = 0;
  };

  LaneMesh<Dim> mesh;
  Point<Dim> spacing{};
  Index<Dim> elements{};  ///< of the whole level
  bool distributed = false;
  MPI_Comm comm = MPI_COMM_SELF;     ///< to sum inner products over
  SharedNodes shared;                ///< empty where the level is not distributed
  std::vector<Range> counted;        ///< nodes this rank counts in inner products
  std::vector<std::int64_t> fixed;   ///< unknowns held at 0: node * components + component, ascending
  Index<Dim> factors{};              ///< to the next level: 2 along coarsened axes
  std::vector<std::int64_t> parent;  ///< element of the next level that each element is in
  LaneTransfer<Dim> transfer;        ///< to the next level

  /// Positions of the mesh's nodes, from the grid's origin, in its unit of length.
  std::vector<Point<Dim>> node_positions() const;
};

/// Sums [node][entry], `entries` per node, over the holders of shared nodes. Collective on the level's
/// communicator.
template <int Dim, class Real>
void sum_over_holders(LaneLevel<Dim>& level, Real* values, int entries);

/// Coarsens an axis as long as its elements are no longer than about those of the others, to a last level of
/// a few hundred elements. The grid is padded with nothing to even counts: any count coarsens.
template <int Dim>
class LaneHierarchy {
 public:
  /// The last level has at most this many elements, if the axes allow it.
  static constexpr std::int64_t coarsest_elements = 600;
  /// Levels with fewer elements per rank are agglomerated.
  static constexpr std::int64_t agglomeration_limit = 400;

  /// Collective on the grid's communicator. Nodes of no element are not in the hierarchy.
  LaneHierarchy(const Grid<Dim>& grid, const SystemDomain& domain);

  int count() const { return static_cast<int>(levels_.size()); }
  LaneLevel<Dim>& level(int index) { return levels_[index]; }
  const LaneLevel<Dim>& level(int index) const { return levels_[index]; }
  /// Numbers of the domain's elements, in its order, in the finest mesh. `domain`: that of the hierarchy.
  std::vector<std::int64_t> element_numbers(const SystemDomain& domain) const;

  /// Factors from a level of `active` elements to the next; all 1 if it is small enough to be the last.
  static Index<Dim> choose_factors(const Index<Dim>& elements, const Point<Dim>& spacing,
                                   std::int64_t active);
  /// Whether a level of so many elements is worth distributing.
  static bool enough_for(int ranks, std::int64_t active) { return active >= agglomeration_limit * ranks; }
  /// Whether a rank's first element begins one of the next level, which is distributed only if all ranks' do.
  static bool begins_on_next(const Index<Dim>& start, const Index<Dim>& factors);

 private:
  void make_finest(const SystemDomain& domain);
  bool coarsen();
  bool keep_distributed(const LaneLevel<Dim>& fine, std::int64_t coarse_elements) const;
  void make_coarse_mesh(const LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse);
  void find_fixed(const LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse);
  bool holds_rigid_motions(const LaneLevel<Dim>& level) const;
  void set_up_sums(LaneLevel<Dim>& level);

  const Grid<Dim>& grid_;
  int components_;
  std::deque<LaneLevel<Dim>> levels_;
};

}  // namespace fabseq
