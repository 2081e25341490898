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

/// Extent of the box and number of its elements. In 2D every element has the given thickness.
template <int Dim>
struct Domain {
  Point<Dim> size{};       ///< edge lengths, length unit
  Index<Dim> elements{};   ///< number of elements along each axis
  double thickness = 1.0;  ///< 2D plane stress only, length unit; 1 in 3D
  Point<Dim> origin{};     ///< lower corner, length unit

  /// Position of a node, and centre of an element, length unit.
  Point<Dim> node_position(const Index<Dim>& node) const {
    Point<Dim> position;
    for (int axis = 0; axis < Dim; ++axis)
      position[axis] = origin[axis] + node[axis] * (size[axis] / elements[axis]);
    return position;
  }
  Point<Dim> element_center(const Index<Dim>& element) const {
    Point<Dim> center;
    for (int axis = 0; axis < Dim; ++axis)
      center[axis] = origin[axis] + (element[axis] + 0.5) * (size[axis] / elements[axis]);
    return center;
  }
};

/// Moves nodal values between the nodes that a rank owns and the ghosted box that its element loops work on.
/// Arrays are [node][component], with nodes lexicographic in Grid::owned_nodes() or Grid::ghosted_nodes().
/// All calls are collective on the communicator.
template <int Dim>
class NodeExchange {
 public:
  /// `nodes`: how the nodes are dealt out to the ranks of `comm`.
  NodeExchange(MPI_Comm comm, const Decomposition<Dim>& nodes, int components);

  /// Copies owned values, and the neighbours' values in the ghosted box, to `ghosted`.
  void to_ghosted(std::span<const double> owned, std::span<double> ghosted) const;
  /// The same, to memory of their own.
  std::vector<double> ghosted(std::span<const double> owned) const;
  /// Sums the values that the element loops of all ranks collected on `ghosted` at the owners of the nodes.
  /// `owned` is overwritten.
  void add_to_owned(std::span<const double> ghosted, std::span<double> owned) const;

 private:
  DmHandle dm_;
  VecHandle owned_, ghosted_;
};

/// A box grid of Q4 or H8 elements, decomposed as a DMDA. The element with index i belongs to the rank that
/// owns its lowest node; the last rank along an axis owns one node more than elements. Ownership ranges are
/// tensor products, chosen so that the largest sum of element weights of a rank is as small as possible.
template <int Dim>
class Grid {
 public:
  /// Collective on `comm`. `weights` is called with one box per rank, on all ranks or on none, and not kept;
  /// empty: all elements have the same weight. A grid can be moved: its exchanges stay where they are, but
  /// parts, halos and other objects that refer to the grid do not follow. Throws InputError on all ranks if
  /// an axis has no elements or no length, if the grid needs more memory than there is, if it has too few
  /// elements to deal out to the ranks, or if it has more elements, nodes or unknowns than indices can count.
  Grid(MPI_Comm comm, const Domain<Dim>& domain, const ElementWeights<Dim>& weights);

  MPI_Comm comm() const { return comm_; }
  const Domain<Dim>& domain() const { return domain_; }
  /// Edge lengths of an element, length unit.
  const Point<Dim>& spacing() const { return spacing_; }
  double smallest_spacing() const { return *std::min_element(spacing_.begin(), spacing_.end()); }
  double largest_spacing() const { return *std::max_element(spacing_.begin(), spacing_.end()); }
  /// Volume of an element (in 2D, area times thickness).
  double element_volume() const;

  /// Boxes of the whole grid.
  IndexBox<Dim> all_elements() const { return {Index<Dim>{}, domain_.elements}; }
  IndexBox<Dim> all_nodes() const;
  /// This rank's elements and nodes. Its element fields are lexicographic in owned_elements(), its nodal
  /// fields in owned_nodes().
  const IndexBox<Dim>& owned_elements() const { return owned_elements_; }
  const IndexBox<Dim>& owned_nodes() const { return owned_nodes_; }
  /// Owned nodes and one layer of nodes around them, within the grid. The box holds all nodes of the owned
  /// elements.
  const IndexBox<Dim>& ghosted_nodes() const { return ghosted_nodes_; }
  /// Elements of every rank.
  const Decomposition<Dim>& decomposition() const { return decomposition_; }

  Point<Dim> element_center(const Index<Dim>& element) const { return domain_.element_center(element); }
  Point<Dim> node_position(const Index<Dim>& node) const { return domain_.node_position(node); }

  /// Offsets, in the ghosted node box, of an element's corners relative to its lowest node.
  const std::array<int, corner_count<Dim>>& corner_offsets() const { return corner_offsets_; }
  /// Offset in the ghosted node box of an owned element's lowest node.
  int first_corner(const Index<Dim>& element) const {
    return static_cast<int>(ghosted_nodes_.offset(element));
  }

  /// Number of an element in PETSc's order: rank after rank, lexicographic within each.
  std::int64_t element_number(const Index<Dim>& element) const;

  /// Exchange for nodal arrays with this many components, which the grid owns. The first call for a number of
  /// components makes it and is collective. Throws InputError if PETSc's indices cannot count the values of
  /// all nodes.
  const NodeExchange<Dim>& exchange(int components) const;

 private:
  MPI_Comm comm_;
  Domain<Dim> domain_;
  Point<Dim> spacing_{};
  Decomposition<Dim> decomposition_;
  IndexBox<Dim> owned_elements_, owned_nodes_, ghosted_nodes_;
  std::array<int, corner_count<Dim>> corner_offsets_{};
  std::vector<std::int64_t> element_starts_;  ///< first number of each rank
  mutable std::map<int, std::unique_ptr<NodeExchange<Dim>>> exchanges_;
};

}  // namespace fabseq
