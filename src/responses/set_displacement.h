// SPDX-License-Identifier: MIT
/// \file
/// The displacements of a node set, on which distortion is measured, and its extent (docs/formulation.md 5).
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/responses/response.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fabseq {

/// Values at this rank's nodes of a set: [owned node of the set], or [owned node of the set][component] of a
/// displacement or of its derivative.
using SetFunction = std::vector<double>;

/// Displacements of a set of nodes, either while the part is on the plate or after the release. Nodes are
/// given as offsets in Grid::owned_nodes(). Nothing here is collective.
template <int Dim>
class SetDisplacement {
 public:
  /// `part` and `nodes` must outlive the object.
  SetDisplacement(const Part<Dim>& part, const NodeSet& nodes, bool after_release)
      : part_(part), nodes_(nodes), after_release_(after_release) {}

  MPI_Comm comm() const { return part_.grid().comm(); }
  const NodeSet& nodes() const { return nodes_; }
  /// Length unit.
  double element_diagonal() const { return std::sqrt(dot(part_.grid().spacing(), part_.grid().spacing())); }
  /// Position of an owned node, length unit.
  Point<Dim> position(int node) const {
    return part_.grid().node_position(part_.grid().owned_nodes().index(node));
  }
  /// Displacement component of an owned node, length unit.
  double at(const StageResults<Dim>& state, int node, int axis) const {
    const std::size_t i = static_cast<std::size_t>(node) * Dim + axis;
    return state.process->displacement[i] + (after_release_ ? state.process->release[i] : 0.0);
  }
  /// The displacement of all owned nodes of the set, length unit.
  SetFunction all(const StageResults<Dim>& state) const {
    SetFunction result;
    for (const int node : nodes_.owned)
      for (int axis = 0; axis < Dim; ++axis) result.push_back(at(state, node, axis));
    return result;
  }
  /// Adds `value` times the derivative of at() to `adjoint`. The displacement after the release is u + v, so
  /// the derivative goes to both.
  void add_derivative(int node, int axis, double value, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const {
    const std::size_t i = static_cast<std::size_t>(node) * Dim + axis;
    zeros_if_empty(adjoint.process.displacement, state)[i] += value;
    if (after_release_) zeros_if_empty(adjoint.process.release, state)[i] += value;
  }
  /// Adds a functional's derivative, `factor` times the function's products with all(), to `adjoint`.
  void add_derivative(const SetFunction& function, double factor, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const {
    prepare(state, adjoint);
    for (std::size_t i = 0; i < nodes_.owned.size(); ++i)
      for (int axis = 0; axis < Dim; ++axis)
        add_derivative(nodes_.owned[i], axis, factor * function[i * Dim + axis], state, adjoint);
  }
  /// Makes room for derivatives. All ranks must call it, also those without a node of the set.
  void prepare(const StageResults<Dim>& state, StageDerivatives<Dim>& adjoint) const {
    zeros_if_empty(adjoint.process.displacement, state);
    if (after_release_) zeros_if_empty(adjoint.process.release, state);
  }

 private:
  static std::vector<double>& zeros_if_empty(std::vector<double>& derivative,
                                             const StageResults<Dim>& state) {
    if (derivative.empty()) derivative.assign(state.process->displacement.size(), 0.0);
    return derivative;
  }

  const Part<Dim>& part_;
  const NodeSet& nodes_;
  bool after_release_;
};

/// Where a set of nodes lies; the same on all ranks.
template <int Dim>
struct SetExtent {
  Point<Dim> center{};  ///< mean of the nodes' positions, length unit
  double radius = 0.0;  ///< largest distance of a node from the centre, length unit

  /// Collective on the grid's communicator.
  explicit SetExtent(const SetDisplacement<Dim>& set) {
    for (const int node : set.nodes().owned)
      for (int axis = 0; axis < Dim; ++axis) center[axis] += set.position(node)[axis];
    sum_in_place(set.comm(), center);
    for (double& coordinate : center) coordinate /= static_cast<double>(set.nodes().count);
    for (const int node : set.nodes().owned) {
      double square = 0.0;
      for (int axis = 0; axis < Dim; ++axis) square += std::pow(set.position(node)[axis] - center[axis], 2);
      radius = std::max(radius, std::sqrt(square));
    }
    radius = max(set.comm(), radius);
  }

  /// A position seen from the centre, relative to the radius.
  Point<Dim> relative(Point<Dim> position) const {
    for (int axis = 0; axis < Dim; ++axis)
      position[axis] = (position[axis] - center[axis]) / (radius > 0.0 ? radius : 1.0);
    return position;
  }
};

}  // namespace fabseq
