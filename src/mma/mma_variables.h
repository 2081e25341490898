// SPDX-License-Identifier: MIT
#pragma once

#include "mma/row_products.h"

#include <mpi.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

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
  Array even, bulge;                               ///< e and 0.501 h
  Array even_slope, bulge_slope, curvature_slope;  ///< derivatives of e, 0.501 h, curvature h, over sqrt(D)
  Array kappa;                                     ///< -d2psi/(dv dbarrier), over sqrt(D)
  Array wall;                                      ///< 0.501 dh/dbarrier
  double curvature_change = 0.0, curvature_wall = 0.0;  ///< of all rows: sums of curvature h, its derivative

  /// Moves v to the minimizers of the Lagrangian.
  void minimize(double barrier);
  /// Sets what the rows need at v.
  void expand(double barrier);

 private:
  double approach(double barrier);
};

/// Where the variables of one update may go, this rank's entries. Lengths are fractions of the variable's
/// step width `beta - alpha`, so that the subproblem is dimensionless: x = x_k + width * v. A new box holds
/// variables that stay.
struct MmaBox {
  std::vector<double> width;           ///< length of v = 1; 0 for a variable that stays
  std::vector<double> upper_distance;  ///< of the asymptote above x_k
  std::vector<double> lower_distance;  ///< of the asymptote below x_k
  std::vector<double> alpha, beta;     ///< bounds of v; alpha <= 0 <= beta, alpha < beta
  std::vector<double> curvature;       ///< what every row gets beside its gradient, 1 / length of x

  explicit MmaBox(std::size_t local);
  std::size_t size() const { return width.size(); }
};

/// Sums over all variables of all ranks where the variables minimize the Lagrangian.
/// G = dg/dv (m rows, n columns); D is the diagonal matrix of the Lagrangian's second derivatives.
struct MmaSums {
  std::vector<double> schur;   ///< G D^-1 G^T = -dg/dlambda, m + 1 by m + 1 by columns, lower triangle; the
                               ///< last row is what moving v adds to dg/dbarrier
  std::vector<double> change;  ///< g_i(v) - f_i, one per row
  std::vector<double> wall;    ///< dg_i/dbarrier at constant v, one per row
};

/// The distributed half of the MMA subproblem: its variables as functions of the rows' multipliers.
///
/// The approximation of row i around x_k (docs/developer/optimizer.md 9.1): with a = U w v / (U - v), b = L w
/// v / (L + v), g_i(v) = f_i + sum_j df_ij e_j(v_j) + (0.501 |df_ij| + curvature_j) h_j(v_j), e = (a + b) /
/// 2, h = a - b, which is Svanberg's sum of p / (upp - x) + q / (x - low) with p = (upp - x_k)^2 (1.001 df+ +
/// 0.001 df- + curvature), q alike. So the rows enter a variable's equation only through S = sum_i lambda_i
/// df_ij and T = sum_i lambda_i (0.501 |df_ij| + curvature_j), the objective with lambda = 1, and no p or q
/// is stored.
///
/// The bounds enter through a barrier in h, -barrier w log(4 (v - alpha) (beta - v)). As every row brings the
/// barrier in proportion to its gradient, v depends only on S / T, however large the multipliers become, and
/// nothing needs a scale.
///
/// `box` and the gradients are borrowed. Collective: start and evaluate.
class MmaVariables {
 public:
  MmaVariables(MPI_Comm comm, const MmaBox& box, std::span<const double> objective_gradient,
               std::span<const std::span<const double>> gradients);

  /// Takes the rows' multipliers to begin with. False, on all ranks, if a gradient is not finite.
  bool start(std::span<const double> lambda);
  /// Sets the direction in which the rows' multipliers are about to move.
  void set_direction(std::span<const double> lambda_direction);
  /// Minimizes the Lagrangian, the rows' multipliers being `t` along the direction, and sums up there. The
  /// sums live until the next call.
  const MmaSums& evaluate(double t, double barrier);
  /// The rows' multipliers go `t` along the direction, which must have been evaluated.
  void advance(double t);

  /// v of the last evaluation.
  std::span<const double> step() const { return v_; }

 private:
  static constexpr std::size_t block_size = MmaBlock::size;  // (m + 1) x block_size doubles stay in the cache

  void combine(std::size_t begin, std::span<const double> lambda, double objective,
               std::vector<double>& plain, std::vector<double>& curved) const;
  void load(std::size_t begin, double t, MmaBlock& block) const;
  void add_rows(std::size_t begin, const MmaBlock& block);
  void reduce();

  MPI_Comm comm_;
  const MmaBox& box_;
  std::span<const double> objective_gradient_;
  std::span<const std::span<const double>> gradients_;

  std::vector<double> lambda_direction_;
  bool direction_is_new_ = false;  // the variables have not heard of it yet
  std::vector<double> v_, plain_, curved_, plain_direction_, curved_direction_;  // v, S, T, dS, dT
  RowProducts scaled_rows_;                                                      // of a block: m + 1 rows
  std::vector<double> message_;
  MmaSums sums_;
};

/// How far above f_i each row's approximation may get anywhere in the box; one per row, the same on all
/// ranks. Collective.
std::vector<double> largest_changes(MPI_Comm comm, const MmaBox& box,
                                    std::span<const std::span<const double>> gradients);

}  // namespace fabseq
