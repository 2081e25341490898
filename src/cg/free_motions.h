// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/rigid_fit.h"
#include "kernels/lane_array.h"
#include "multigrid/lane_hierarchy.h"

#include <span>
#include <vector>

namespace fabseq {

/// Projections of one system's vectors, [node][component] on the finest level, to the space without rigid
/// motions R, for a body that nothing holds. All calls are collective on the level's communicator.
template <int Dim>
class FreeMotions {
 public:
  /// `stiffness`: factor of each element of the mesh; the body is all of the mesh, in one piece. The level
  /// must outlive the object.
  FreeMotions(LaneLevel<Dim>& level, std::span<const double> stiffness);

  /// Takes the mean rigid motion out: u -= R (R^T R)^-1 R^T u.
  void remove(LaneValues<float>& displacement) const;
  /// Takes the resultants out: f -= W R (R^T W R)^-1 R^T f, W the stiffness around each node. What is taken
  /// away so acts where the body is stiff: forces in the void, be they rounding, would move it far.
  void balance(LaneArray& forces) const;

 private:
  template <class Weight>
  RigidFit<Dim> fit(Weight&& weight) const;
  template <class Real, class Weight>
  void project(LaneValues<Real>& values, const RigidFit<Dim>& fit, Weight&& weight) const;

  const LaneLevel<Dim>& level_;
  std::vector<Point<Dim>> positions_;  ///< of the nodes, from their centre, in units of the grid's extent
  LaneArray stiffness_;                ///< sum over the elements around each node
  RigidFit<Dim> displacements_, forces_;
};

}  // namespace fabseq
