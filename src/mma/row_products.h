// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/lane_array.h"
#include "kernels/lanes.h"

#include <cstddef>
#include <span>

namespace fabseq {

/// Rows of a matrix A, a few dozen of a few hundred columns at a time, whose products A A^T are summed up. A
/// BLAS made for large matrices does this at a fraction of its speed. Not collective.
class RowProducts {
 public:
  /// Columns come in multiples of this; those behind the last one are to be 0.
  static constexpr std::size_t column_step = native_lanes;

  /// `columns`: room for so many, a multiple of column_step.
  RowProducts(std::size_t rows, std::size_t columns);

  double* row(std::size_t index) { return values_.data() + index * columns_; }
  /// Adds A A^T, as far as the first `columns` make it, to the lower triangle of a square matrix, which is
  /// stored column by column. `columns` is a multiple of column_step.
  void add_to(std::span<double> sums, std::size_t columns) const;

 private:
  /// Rows and columns of the products that registers hold at a time.
  static constexpr std::size_t tile = register_bytes == 64 ? 4 : 2;

  std::size_t rows_, columns_;
  LaneArray values_;  ///< row by row, filled up to whole tiles with 0
};

}  // namespace fabseq
