// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace fabseq {

/// The Lanczos matrix of a run of preconditioned conjugate gradients: its smallest eigenvalue falls towards
/// that of M K as the run goes on. The error is at most about |M r| divided by it, so that a small one warns
/// of motions the preconditioner hardly sees.
class SpectrumEstimate {
 public:
  /// A step of length `alpha` along a direction that kept `beta` times the one before (0 in the first step).
  void add(double alpha, double beta);
  /// Estimate of the smallest eigenvalue; 1 before the first step.
  double smallest() const;

 private:
  /// Whether the matrix minus `shift` is positive definite.
  bool is_below_spectrum(double shift) const;

  std::vector<double> diagonal_, squared_off_diagonal_;
  double last_alpha_ = 0.0;
};

}  // namespace fabseq
