// SPDX-License-Identifier: MIT
/// \file
/// A few of the MMA subproblem's variables, small enough for the cache: their minimizers and what the rows
/// need there.
#pragma once

#include <array>
#include <cstddef>

namespace fabseq {

/// Half of 1.001 + 0.001 (Svanberg 2007): what a row's convex part gets of its gradient's size.
constexpr double mma_bulge_factor = 0.501;

/// Entry k of each array belongs to the block's variable k. Formulas and symbols: MmaVariables.
struct MmaBlock {
  static constexpr std::size_t size = 512;
  using Array = std::array<double, size>;

  std::size_t count = 0;                              ///< entries in use
  Array upper, lower, alpha, beta, curvature, width;  ///< of the box
  Array ratio;                                        ///< S / (2 T), from -1 to 1: it alone decides v
  Array curved;                                       ///< T
  Array v;                                            ///< start of minimize() and its result

  // What expand() finds.
  Array even, bulge;  ///< e and 0.501 h
  Array even_slope, bulge_slope,
      curvature_slope;  ///< derivatives of e, 0.501 h, curvature h, over sqrt(D)
  Array kappa;          ///< -d2psi/(dv dbarrier), over sqrt(D)
  Array wall;           ///< 0.501 dh/dbarrier
  double curvature_change = 0.0,
         curvature_wall = 0.0;  ///< sums of curvature h and its derivative, the same for all rows

  /// Moves v to the minimizers of the Lagrangian.
  void minimize(double barrier);
  /// Sets what the rows need at v.
  void expand(double barrier);

 private:
  double approach(double barrier);
};

}  // namespace fabseq
