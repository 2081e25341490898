// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/grid/rigid_fit.h"

#include <span>
#include <vector>

namespace fabseq {

/// The rigid motions R of all nodes (translations and rotations), and their least-squares fit C = (R_P^T
/// R_P)^-1 R_P^T to the displacements of a set of nodes P (docs/formulation.md 4.3). Rotations are about the
/// centre of P, in units of its extent. Displacements and forces are [owned node][component]. All calls but
/// determined() are collective on the grid's communicator.
template <int Dim>
class RigidMotions {
 public:
  /// `nodes`: this rank's nodes of P, as offsets in Grid::owned_nodes(). The grid must outlive the object.
  RigidMotions(const Grid<Dim>& grid, std::vector<int> nodes);

  /// Whether P determines the fit: no rigid motion leaves all of P where it is. The other calls need that.
  bool determined() const { return determined_; }
  /// Subtracts the fitted rigid motion R C u from a displacement u, in place.
  void remove_fit(std::span<double> displacement) const;
  /// Subtracts C^T R^T b from forces b, in place, so that they have no resultants. The transpose of
  /// remove_fit().
  void balance(std::span<double> forces) const;

 private:
  static constexpr int count = rigid_motion_count<Dim>;
  using Amplitudes = typename RigidFit<Dim>::Amplitudes;

  /// A node's position relative to the centre, in units of the extent.
  Point<Dim> position(const Index<Dim>& node) const;

  const Grid<Dim>& grid_;
  std::vector<int> nodes_;
  Point<Dim> center_{};
  double extent_ = 1.0;
  RigidFit<Dim> fit_;  ///< factor of R_P^T R_P
  bool determined_ = false;
};

}  // namespace fabseq
