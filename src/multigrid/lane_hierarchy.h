// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/grid/grid.h"
#include "fabseq/grid/unknown_numbering.h"
#include "kernels/lane_mesh.h"
#include "kernels/lane_transfer.h"
#include "ranks/lane_deal.h"
#include "ranks/level_gather.h"
#include "ranks/level_shares.h"
#include "ranks/shared_nodes.h"

#include <cstdint>
#include <deque>
#include <vector>

namespace fabseq {

/// One level of the lane multigrid, common to all lanes. Its elements are dealt out to as many ranks as have
/// enough to do; on the others its mesh is empty, so that they take every step without doing anything. Where
/// the grid has several ranks, the last level's mesh is whole on all of them: its lanes are dealt out.
template <int Dim>
struct LaneLevel {
  /// Nodes begin ... end - 1.
  struct Range {
    std::int64_t begin = 0, end = 0;
  };

  LaneMesh<Dim> mesh;  ///< this rank's part
  Point<Dim> spacing{};
  Index<Dim> elements{};            ///< of the whole level
  LevelShares<Dim> shares;          ///< who holds it; nobody if its lanes are dealt out
  bool lanes_dealt = false;         ///< the last level, of several ranks
  bool distributed = false;         ///< this rank holds a part, and others hold the rest
  MPI_Comm comm = MPI_COMM_SELF;    ///< of its holders, to sum inner products over
  SharedNodes shared;               ///< empty where the level is not distributed
  std::vector<Range> counted;       ///< nodes this rank counts in inner products
  std::vector<std::int64_t> fixed;  ///< unknowns held at 0: node * components + component, ascending
  Index<Dim> factors{};             ///< to the next level: 2 along coarsened axes
  bool staged = false;      ///< what ranks' elements lie in on the next level is not just what they hold
  LaneMesh<Dim> stage;      ///< what they lie in, if `staged`; else that is the next level's mesh
  LevelGather<Dim> gather;  ///< from the stage to the next level; not used if its lanes are dealt out
  /// Numbers of the stage's nodes in a next level whose lanes are dealt out.
  std::vector<std::int64_t> dealt;
  /// Element that each element is in: of the stage if the next level is gathered, else of that level.
  std::vector<std::int64_t> parent;
  LaneTransfer<Dim> transfer;  ///< to the stage or the next level

  /// Positions of the mesh's nodes, from the grid's origin, in its unit of length.
  std::vector<Point<Dim>> node_positions() const;
};

/// Sums [node][entry], `entries` per node, over the holders of shared nodes. Collective on the level's
/// communicator.
template <int Dim, class Real>
void sum_over_holders(LaneLevel<Dim>& level, Real* values, int entries);

/// Finds what is held of a coarse level, `coarse.fixed`, from what is held of the finer one, `fine.fixed`
/// (docs/developer/lane-engine.md 11.2), with `components` unknowns per node. Meshes, stage and sums of both
/// levels must be there. Collective on `comm`, the grid's communicator.
template <int Dim>
void find_coarse_supports(MPI_Comm comm, LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse, int components);

/// Coarsens an axis as long as its elements are no longer than about those of the others, to a last level of
/// at most coarsest_elements(). The grid is padded with nothing to even counts: any count coarsens.
template <int Dim>
class LaneHierarchy {
 public:
  /// The last level has at most this many elements, if the axes allow it: its band's factors grow with the
  /// cube of the unknowns of a node.
  static constexpr std::int64_t coarsest_elements(int components) { return 600 / components; }

  /// Collective on the grid's communicator. Nodes of no element are not in the hierarchy.
  LaneHierarchy(const Grid<Dim>& grid, const SystemDomain& domain);

  int count() const { return static_cast<int>(levels_.size()); }
  LaneLevel<Dim>& level(int index) { return levels_[index]; }
  const LaneLevel<Dim>& level(int index) const { return levels_[index]; }
  /// Takes the last level's lanes to their owners, if `lanes_dealt`, from the stage of the level above.
  LaneDeal& deal() { return deal_; }
  /// Numbers of the domain's elements, in its order, in the finest mesh. `domain`: that of the hierarchy.
  std::vector<std::int64_t> element_numbers(const SystemDomain& domain) const;

  /// Factors from a level of `active` elements to the next; all 1 if it is small enough to be the last.
  /// `components`: unknowns of a node.
  static Index<Dim> choose_factors(const Index<Dim>& elements, const Point<Dim>& spacing, std::int64_t active,
                                   int components);
  /// Mesh of what the elements of a mesh lie in on the next level, within its box `parents`.
  static LaneMesh<Dim> stage_of(const LaneMesh<Dim>& fine, const IndexBox<Dim>& parents,
                                const Index<Dim>& factors);

 private:
  void make_finest(const SystemDomain& domain);
  bool coarsen();
  void make_coarse_mesh(LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse);
  void deal_lanes_out(LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse);
  void set_up_sums(LaneLevel<Dim>& level);

  const Grid<Dim>& grid_;
  int components_;
  std::int64_t active_ = 0;  ///< elements of the last level so far
  LaneDeal deal_;
  std::deque<Communicator> comms_;  ///< of levels that not all ranks hold
  std::deque<LaneLevel<Dim>> levels_;
};

}  // namespace fabseq
