// SPDX-License-Identifier: MIT
/// \file
/// The uniform box grid and its decomposition over the ranks (docs/formulation.md 1).
#pragma once

#include "fabseq/base/petsc.h"
#include "fabseq/grid/decomposition.h"
#include "fabseq/grid/index_box.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// Extent of the box and its elements; in 2D every element has the given thickness.
template <int Dim>
struct Domain {
  Point<Dim> size{};       ///< edge lengths, length unit
  Index<Dim> elements{};   ///< elements along each axis
  double thickness = 1.0;  ///< 2D plane stress only, length unit; 1 in 3D
};

/// Centre of an element, for those who have no grid yet.
template <int Dim>
Point<Dim> element_center(const Domain<Dim>& domain, const Index<Dim>& element) {
  Point<Dim> center;
  for (int axis = 0; axis < Dim; ++axis)
    center[axis] = (element[axis] + 0.5) * (domain.size[axis] / domain.elements[axis]);
  return center;
}

/// Moves nodal values between the nodes a rank owns and the ghosted box its element loops work on. Arrays are
/// [node][component], nodes lexicographic in Grid::owned_nodes() or Grid::ghosted_nodes(). All calls are
/// collective.
template <int Dim>
class NodeExchange {
 public:
  /// `dm`: a DMDA with `components` degrees of freedom per node; not owned, must outlive the exchange.
  /// Collective.
  NodeExchange(DM dm, int components);

  /// Copies owned values and those of the neighbours' nodes in the ghosted box.
  void to_ghosted(std::span<const double> owned, std::span<double> ghosted) const;
  /// Adds what element loops collected on `ghosted` nodes to their owners; `owned` is overwritten.
  void add_to_owned(std::span<const double> ghosted, std::span<double> owned) const;

 private:
  DM dm_;
  VecHandle owned_, ghosted_;
};

/// A DMDA (box stencil of width 1). `nodes`: that each process has along each axis. Collective.
template <int Dim>
DmHandle make_node_dm(MPI_Comm comm, const Index<Dim>& processes,
                      const std::array<std::vector<PetscInt>, Dim>& nodes, int components);

/// A DMDA-decomposed box grid of Q4 or H8 elements. The element with index i belongs to the rank that owns
/// its lowest node; the last rank along an axis owns one node more than elements. Ownership ranges are tensor
/// products, chosen so that the largest sum of element weights of a rank is smallest.
template <int Dim>
class Grid {
 public:
  /// Weights of the elements of a box, lexicographic (for load balance only); called on a part of the grid on
  /// each rank, by all ranks or none. Empty: all elements alike.
  using WeightFunction = ElementWeights<Dim>;

  /// Collective on `comm`. Throws InputError if the grid has fewer elements than can be dealt out to the
  /// ranks, or more unknowns than PETSc's indices hold. The grid holds no reference to `weights` afterwards.
  /// A grid can be moved: DMs and exchanges stay where they are; parts, halos and the like that refer to the
  /// moved grid do not follow.
  Grid(MPI_Comm comm, const Domain<Dim>& domain, const WeightFunction& weights);

  MPI_Comm comm() const { return comm_; }
  const Domain<Dim>& domain() const { return domain_; }
  /// Element edge lengths.
  const Point<Dim>& spacing() const { return spacing_; }
  double smallest_spacing() const { return *std::min_element(spacing_.begin(), spacing_.end()); }
  double largest_spacing() const { return *std::max_element(spacing_.begin(), spacing_.end()); }
  /// Volume of an element (2D: area times thickness).
  double element_volume() const;

  /// The whole grid.
  IndexBox<Dim> all_elements() const { return {Index<Dim>{}, domain_.elements}; }
  IndexBox<Dim> all_nodes() const;
  /// This rank's share. Local element fields are lexicographic in owned_elements().
  const IndexBox<Dim>& owned_elements() const { return owned_elements_; }
  const IndexBox<Dim>& owned_nodes() const { return owned_nodes_; }
  /// Owned nodes and one layer around them, within the grid; holds all nodes of the owned elements.
  const IndexBox<Dim>& ghosted_nodes() const { return ghosted_nodes_; }
  /// Ranks along each axis; rank = px + Px (py + Py pz).
  const Index<Dim>& processes() const { return decomposition_.processes; }

  Point<Dim> element_center(const Index<Dim>& element) const;
  Point<Dim> node_position(const Index<Dim>& node) const;

  /// Offsets, in the ghosted node box, of an element's corners relative to its lowest node.
  const std::array<int, corner_count<Dim>>& corner_offsets() const { return corner_offsets_; }
  /// Offset in the ghosted node box of an owned element's lowest node.
  int first_corner(const Index<Dim>& element) const {
    return static_cast<int>(ghosted_nodes_.offset(element));
  }

  /// Position of an element in the order "ranks one after the other, each lexicographic" (PETSc's order).
  std::int64_t element_number(const Index<Dim>& element) const;
  std::int64_t node_number(const Index<Dim>& node) const;

  /// DMDA over the nodes with this many components (box stencil of width 1); owned by the grid, made at first
  /// use (collective). Throws InputError if the values of all nodes are more than PETSc's indices hold.
  DM node_dm(int components) const;
  /// Exchange for nodal arrays with this many components; owned by the grid, made at first use (collective).
  const NodeExchange<Dim>& exchange(int components) const;

 private:
  void set_up_boxes();

  MPI_Comm comm_;
  Domain<Dim> domain_;
  Point<Dim> spacing_{};
  Decomposition<Dim> decomposition_;
  IndexBox<Dim> owned_elements_, owned_nodes_, ghosted_nodes_;
  std::array<int, corner_count<Dim>> corner_offsets_{};
  std::vector<std::int64_t> element_starts_, node_starts_;  ///< first number of each rank
  mutable std::map<int, DmHandle> node_dms_;
  mutable std::map<int, std::unique_ptr<NodeExchange<Dim>>> exchanges_;
};

}  // namespace fabseq
