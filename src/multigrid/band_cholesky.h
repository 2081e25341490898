// SPDX-License-Identifier: MIT
/// \file
/// Direct solve of the coarsest level (LAPACK's band Cholesky).
#pragma once

#include "kernels/lane_mesh.h"

#include <span>
#include <vector>

namespace fabseq {

/// Numbers the unknowns of a mesh so that the band is narrow: along the shortest axis first.
template <int Dim>
struct BandNumbering {
  BandNumbering(const LaneMesh<Dim>& mesh, int components);

  std::vector<int> rows;  ///< of each unknown (node * components + component)
  int bandwidth = 0;      ///< diagonals below the main one
};

/// A symmetric positive definite band matrix and its factorization.
class BandCholesky {
 public:
  /// Zeros.
  void resize(int size, int bandwidth);
  /// Adds to the entry (row, column); the upper triangle is ignored.
  void add(int row, int column, double value) {
    if (row >= column) band_[static_cast<std::size_t>(column) * (bandwidth_ + 1) + row - column] += value;
  }
  /// Adds to every diagonal entry this share of itself.
  void raise_diagonal(double share) {
    for (std::size_t at = 0; at < band_.size(); at += static_cast<std::size_t>(bandwidth_) + 1)
      band_[at] *= 1.0 + share;
  }
  /// Rows without anything on the diagonal get a 1 there. False if the matrix is not positive definite.
  bool factor();
  /// Solves in place.
  void solve(std::span<double> values) const;

  int size() const { return size_; }
  int bandwidth() const { return bandwidth_; }
  /// The last row where a column of the factor is not zero.
  int last_row(int column) const;
  /// Returns the lower triangle's, after factor() the factor's; zero outside the band and below the last row.
  double entry(int row, int column) const {
    if (row - column > bandwidth_ || row >= size_) return 0.0;
    return band_[static_cast<std::size_t>(column) * (bandwidth_ + 1) + row - column];
  }

 private:
  int size_ = 0, bandwidth_ = 0;
  std::vector<double> band_;  ///< LAPACK's lower band storage
};

}  // namespace fabseq
