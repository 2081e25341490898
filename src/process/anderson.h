// SPDX-License-Identifier: MIT
#pragma once

#include <mpi.h>

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

namespace fabseq {

/// Anderson's acceleration of an iteration x <- x + z(x): the next x is that combination of the last ones
/// whose steps z add up to least, plus that step, by weighted least squares. Vectors are this rank's part;
/// what is kept of earlier iterations is in single precision. Source: D. G. Anderson, Iterative procedures
/// for nonlinear integral equations, J. ACM 12 (1965); H. F. Walker, P. Ni, SIAM J. Numer. Anal. 49 (2011).
class Anderson {
 public:
  /// `depth`: number of earlier steps that are combined. `weights`: of the entries in products, not negative;
  /// must outlive the object.
  Anderson(MPI_Comm comm, std::size_t depth, std::span<const float> weights)
      : comm_(comm), depth_(depth), weights_(weights) {}

  /// Sets x to the next iterate. Returns the norms of the step and of x. Collective on `comm`.
  struct Norms {
    double step, x;
  };
  Norms advance(std::vector<double>& x, const std::vector<double>& step);

 private:
  /// Change from one iteration to the next.
  struct Change {
    std::vector<float> step;  ///< of z
    std::vector<float> both;  ///< of x + z
  };
  void keep_change(const std::vector<double>& step);
  std::vector<double> factors(std::vector<double> sums, double& square) const;

  MPI_Comm comm_;
  std::size_t depth_;
  std::span<const float> weights_;
  std::vector<float> last_step_, last_move_;  ///< z, and what was added to x; empty: first iteration
  bool has_last_ = false;
  std::deque<Change> changes_;
};

}  // namespace fabseq
