// SPDX-License-Identifier: MIT
/// \file
/// Rigid motions of the grid's nodes, fitted to some of them (docs/formulation.md 4.3).
#pragma once

#include "fabseq/grid/grid.h"

#include <array>
#include <span>
#include <vector>

namespace fabseq {

/// The translations and rotations R of all nodes, and their least-squares fit C = (R_P^T R_P)^-1 R_P^T to the
/// displacements of a set of nodes P. Rotations are about the centre of the set, in units of its extent.
/// Displacements and forces are [owned node][component]. All calls but determined() are collective on the
/// grid's communicator.
template <int Dim>
class RigidMotions {
 public:
  static constexpr int count = Dim * (Dim + 1) / 2;
  using Amplitudes = std::array<double, count>;

  /// `nodes`: P, offsets in Grid::owned_nodes(). The grid must outlive the object.
  RigidMotions(const Grid<Dim>& grid, std::vector<int> nodes);

  /// Whether no rigid motion leaves all of P where it is; otherwise there is no fit.
  bool determined() const { return determined_; }
  /// Takes R C u out of a displacement u.
  void remove_fit(std::span<double> displacement) const;
  /// Takes C^T R^T b out of forces b: what is left has no resultants. The transpose of remove_fit().
  void balance(std::span<double> forces) const;

 private:
  Point<Dim> mode(int number, const Index<Dim>& node) const;
  void factor(std::vector<double> normal);
  /// (R_P^T R_P)^-1 of a vector.
  Amplitudes solve(Amplitudes right) const;

  const Grid<Dim>& grid_;
  std::vector<int> nodes_;
  Point<Dim> center_{};
  double extent_ = 1.0;
  std::array<Amplitudes, count> factor_{};  ///< lower Cholesky factor of R_P^T R_P
  bool determined_ = false;
};

extern template class RigidMotions<2>;
extern template class RigidMotions<3>;

}  // namespace fabseq
