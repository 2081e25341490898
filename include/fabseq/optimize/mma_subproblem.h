/// \file
/// The convex subproblem of an MMA update.
#pragma once

#include "fabseq/optimize/mma.h"

#include <mpi.h>

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Where the variables of one update may go, this rank's entries. Lengths are fractions of the variable's step width
/// `beta - alpha`, so that the subproblem is dimensionless: x = x_k + width * v. A new box holds variables that stay.
struct MmaBox {
  std::vector<double> width;           ///< length of v = 1; 0 for a variable that stays
  std::vector<double> upper_distance;  ///< of the asymptote above x_k
  std::vector<double> lower_distance;  ///< of the asymptote below x_k
  std::vector<double> alpha, beta;     ///< bounds of v; alpha <= 0 <= beta, alpha < beta
  std::vector<double> curvature;       ///< what every row gets beside its gradient, 1 / length of x

  explicit MmaBox(std::size_t local);
  std::size_t size() const { return width.size(); }
};

/// Approximation of a row (or the objective) in one variable, p / (U - v) + q / (v + L): its gradient at v = 0, convex, with poles
/// at the asymptotes (Svanberg 2007, equations 3.2 to 3.6).
struct MmaApproximation {
  /// `gradient`: of the row with respect to x.
  MmaApproximation(const MmaBox& box, std::size_t variable, double gradient);
  double value(double v) const { return p / (upper - v) + q / (v + lower); }

  double p = 0.0, q = 0.0;
  double upper = 1.0, lower = 1.0;
};

/// Minimizes, over v in [alpha, beta], y >= 0, z >= 0,
///
///     sum_j (p_0j / (U_j - v_j) + q_0j / (v_j + L_j)) + a_0 z + sum_i (c_i y_i + d_i y_i^2 / 2)
///     subject to sum_j (p_ij / (U_j - v_j) + q_ij / (v_j + L_j)) - a_i z - y_i <= b_i
///
/// (Svanberg 2007, sections 4 and 5) by a primal-dual interior-point method: Newton steps on the relaxed optimality conditions,
/// the relaxation lowered tenfold whenever they hold; v is eliminated, so that a step costs one pass over the variables and
/// the solution of m + 1 equations on every rank. Values and gradients are those of the rows at v = 0. Returns v, this rank's
/// entries, 0 for variables that stay. Collective; throws NumericalError on all ranks if the method breaks down.
std::vector<double> solve_mma_subproblem(MPI_Comm comm, const MmaBox& box,
                                         std::span<const double> objective_gradient,
                                         std::span<const double> values,
                                         std::span<const std::span<const double>> gradients,
                                         const MmaRows& rows, MmaReport& report);

}  // namespace fabseq
