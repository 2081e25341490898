/// \file
/// Direct solve of the coarsest level (LAPACK's band Cholesky).
#pragma once

#include "fabseq/fem/lane_mesh.h"

#include <petscsys.h>

#include <cstdint>
#include <span>
#include <vector>

namespace fabseq {

/// Numbers the unknowns of a mesh so that the band is narrow: along the shortest axis first.
template <int Dim>
class BandNumbering {
 public:
  BandNumbering() = default;
  BandNumbering(const LaneMesh<Dim>& mesh, int components);

  /// Row of each unknown (node * components + component).
  const std::vector<int>& rows() const { return rows_; }
  /// Diagonals below the main one.
  int bandwidth() const { return bandwidth_; }

 private:
  std::vector<int> rows_;
  int bandwidth_ = 0;
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
  /// Rows without anything on the diagonal get a 1 there. False if the matrix is not positive definite.
  bool factor();
  /// Solves in place for `count` right-hand sides, one after the other in memory.
  void solve(std::span<double> values, int count) const;

 private:
  PetscBLASInt size_ = 0, bandwidth_ = 0;
  std::vector<double> band_;  ///< LAPACK's lower band storage
};

extern template class BandNumbering<2>;
extern template class BandNumbering<3>;

}  // namespace fabseq
