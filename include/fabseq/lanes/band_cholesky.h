// SPDX-License-Identifier: MIT
/// \file
/// Direct solve of the coarsest level (LAPACK's band Cholesky).
#pragma once

#include "fabseq/lanes/lane_mesh.h"
#include "fabseq/lanes/lanes.h"

#include <algorithm>
#include <array>
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
  /// Solves in place for several right-hand sides, [row][lane].
  template <int Width>
  void solve_lanes(std::span<double> values) const;

 private:
  int size_ = 0, bandwidth_ = 0;
  std::vector<double> band_;  ///< LAPACK's lower band storage
};

/// One pass over the factor for all lanes, where LAPACK takes one per right-hand side.
template <int Width>
void BandCholesky::solve_lanes(std::span<double> values) const {
  using Value = Lanes<Width>;
  const auto at = [&](int row) { return values.data() + static_cast<std::size_t>(row) * Width; };
  const auto column = [&](int j) { return &band_[static_cast<std::size_t>(j) * (bandwidth_ + 1)]; };
  for (int j = 0; j < size_; ++j) {
    const double* const factor = column(j);
    const Value value = Value::load(at(j)) * (1.0 / factor[0]);
    value.store(at(j));
    for (int i = 1; i <= std::min(bandwidth_, size_ - 1 - j); ++i)
      (Value::load(at(j + i)) - value * factor[i]).store(at(j + i));
  }
  for (int j = size_ - 1; j >= 0; --j) {
    const double* const factor = column(j);
    std::array<Value, 2> sums{Value::zero(), Value::zero()};  // side by side: each waits for itself only
    for (int i = 1; i <= std::min(bandwidth_, size_ - 1 - j); ++i)
      sums[i % 2] += Value::load(at(j + i)) * factor[i];
    ((Value::load(at(j)) - (sums[0] + sums[1])) * (1.0 / factor[0])).store(at(j));
  }
}

}  // namespace fabseq
