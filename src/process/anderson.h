// SPDX-License-Identifier: MIT
#pragma once

#include <mpi.h>

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

namespace fabseq {

/// Anderson's acceleration of an iteration x <- x + z(x): the next x is that combination of the last ones
/// whose steps z add up to least, plus that step, by weighted least squares. Vectors are this rank's part.
/// Source: D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965); H. F.
/// Walker, P. Ni, SIAM J. Numer. Anal. 49 (2011).
class Anderson {
 public:
  /// `depth`: number of earlier steps that are combined. `weights`: of the entries in products, not negative;
  /// must outlive the object.
  Anderson(MPI_Comm comm, std::size_t depth, std::span<const double> weights)
      : comm_(comm), depth_(depth), weights_(weights) {}

  /// Sets x to the next iterate. Collective on `comm`.
  void advance(std::vector<double>& x, const std::vector<double>& step);
  /// Root of the weighted square of a vector. Collective on `comm`.
  double norm(std::span<const double> values) const;

 private:
  double product(std::span<const double> a, std::span<const double> b) const;

  MPI_Comm comm_;
  std::size_t depth_;
  std::span<const double> weights_;
  std::vector<double> last_x_, last_step_;
  std::deque<std::vector<double>> x_changes_, step_changes_;
};

}  // namespace fabseq
