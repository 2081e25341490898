// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mma/mma_settings.h"

#include <mpi.h>

#include <span>
#include <vector>

namespace fabseq {

struct MmaBox;

/// The general form min f0 + a0 z + sum_i (c_i y_i + d_i y_i^2 / 2), f_i - a_i z - y_i <= 0, y_i, z >= 0.
/// An ordinary constraint has a = 0, c large, d = 1; a least-squares residual enters as a pair +r, -r with c
/// = 0, d = 2; values whose largest is to be made small enter as rows with a = 1, for a0 = 1 and no other use
/// of z.
struct MmaRows {
  double a0 = 1.0;
  std::vector<double> a, c, d;  ///< one entry per row

  /// Adds so many rows with these coefficients.
  void add(std::size_t count, double row_a, double row_c, double row_d);
  void add_constraints(std::size_t count) { add(count, 0.0, 1000.0, 1.0); }
  /// The pairs of so many least-squares residuals.
  void add_residuals(std::size_t count) { add(2 * count, 0.0, 0.0, 2.0); }
  /// So many values whose largest, z, is part of the objective.
  void add_largest_of(std::size_t count) { add(count, 1.0, 1000.0, 1.0); }
};

/// What an update found out.
struct MmaReport {
  int newton_steps = 0;
  bool converged = true;      ///< false only while more conservative approximations are still to be tried
  double kkt_residual = 0.0;  ///< largest residual of the subproblem's optimality conditions
  std::vector<double> multipliers;  ///< lambda of each row
  double largest_violation = 0.0;   ///< largest y_i of rows with c > 0: how far the subproblem relaxed one
};

/// What an update remembers of the updates before: low_, upp_ (asymptotes) and the two last x, this rank's
/// entries. Entries follow the variables, so a checkpoint may hand them to other ranks.
struct MmaState {
  int iteration = 0;  ///< updates so far
  std::vector<double> low, upp, previous, before_previous;
};

/// The method of moving asymptotes, one design update after the other (Svanberg, "The method of moving
/// asymptotes", 1987, and "MMA and GCMMA", 2007; distribution over ranks after Aage & Lazarov 2013: variables
/// are distributed, rows are on every rank). The iterates do not depend on the number of ranks beyond
/// rounding. Collective on `comm`.
class Mma {
 public:
  /// `local`: number of variables on this rank (may be 0).
  Mma(MPI_Comm comm, std::size_t local, const MmaSettings& settings);

  /// Returns what checkpoints keep; a restored state gives the iterates of a run that was not interrupted.
  const MmaState& state() const { return state_; }
  /// `state`: this rank's entries; vectors of the length given to the constructor.
  void restore(MmaState state);

  /// Moves `x` to the solution of the convex subproblem.
  /// \param x                   variables, this rank's (in and out)
  /// \param objective_gradient  df0/dx, this rank's
  /// \param values              f_i, one per row, equal on all ranks
  /// \param gradients           df_i/dx, per row one vector of this rank's entries
  /// \param lower,upper         bounds of each variable; equal ones hold it, their distance is its range
  /// \param move_limit          largest step, fraction of the range
  /// \param rows                the general form's coefficients of each row
  ///
  /// Throws NumericalError if values or gradients are not finite or the subproblem breaks down.
  MmaReport update(std::span<double> x, std::span<const double> objective_gradient,
                   std::span<const double> values, std::span<const std::vector<double>> gradients,
                   std::span<const double> lower, std::span<const double> upper, double move_limit,
                   const MmaRows& rows);

 private:
  void move_asymptotes(std::span<const double> x, std::span<const double> lower,
                       std::span<const double> upper);

  MmaBox box(std::span<const double> x, std::span<const double> lower, std::span<const double> upper,
             double move_limit) const;

  MPI_Comm comm_;
  MmaSettings settings_;
  MmaState state_;
};

}  // namespace fabseq
