// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/lane_array.h"

#include <mpi.h>

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Anderson's acceleration of an iteration x <- x + z(x): the next x is that combination of the last ones
/// whose steps z add up to least, plus that step, by weighted least squares. Vectors are this rank's part;
/// what is kept of earlier iterations is in single precision. Source: D. G. Anderson, Iterative procedures
/// for nonlinear integral equations, J. ACM 12 (1965); H. F. Walker, P. Ni, SIAM J. Numer. Anal. 49 (2011).
class Anderson {
 public:
  /// `depth`: number of earlier steps that are combined.
  Anderson(MPI_Comm comm, std::size_t depth) : comm_(comm), depth_(depth) {}
  /// Begins another iteration. `weights`: of the entries in products, not negative; must outlive it.
  void start(std::span<const float> weights);

  /// Sets x to the next iterate. Returns the norms of the step and of x. Collective on `comm`.
  struct Norms {
    double step, x;
  };
  Norms advance(std::vector<double>& x, const std::vector<double>& step);

 private:
  /// Change from one iteration to the next.
  struct Change {
    LaneValues<float> step;  ///< of z
    LaneValues<float> both;  ///< of x + z
  };
  void make_room(std::size_t entries);
  void begin_piece(std::size_t begin, std::span<const double> step, double* of_newest, double* of_step);
  std::vector<double> products(const std::vector<double>& step);
  std::vector<double> factors(std::span<const double> products);
  double move(std::size_t begin, std::span<const double> factors, std::span<const double> step, double* x);

  MPI_Comm comm_;
  std::size_t depth_;
  std::span<const float> weights_;
  LaneValues<float> last_step_, last_move_;  ///< z, and what was added to x
  bool has_last_ = false;
  std::vector<Change> changes_;
  std::size_t count_ = 0, newest_ = 0;  ///< of the changes; others are memory of an earlier iteration
  std::vector<double> products_;        ///< of the changes with each other, [depth][depth]
};

}  // namespace fabseq
