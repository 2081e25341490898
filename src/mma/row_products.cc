// SPDX-License-Identifier: MIT
#include "mma/row_products.h"

#include <array>

namespace fabseq {

namespace {

using Value = Lanes<native_lanes>;

template <std::size_t Tile>
using Products = std::array<std::array<double, Tile>, Tile>;

double sum_of(const Value& value) {
  double result = 0.0;
  for (int lane = 0; lane < Value::width; ++lane) result += value[lane];
  return result;
}

/// Products of `Tile` rows from `a` with as many from `b`; rows are `stride` apart.
template <std::size_t Tile>
Products<Tile> products(const double* a, const double* b, std::size_t stride, std::size_t columns) {
  std::array<std::array<Value, Tile>, Tile> sums;
  for (auto& of_row : sums) of_row.fill(Value::zero());
  for (std::size_t column = 0; column < columns; column += native_lanes) {
    std::array<Value, Tile> of_b;
    for (std::size_t j = 0; j < Tile; ++j) of_b[j] = Value::load(b + j * stride + column);
    for (std::size_t i = 0; i < Tile; ++i) {
      const Value of_a = Value::load(a + i * stride + column);
      for (std::size_t j = 0; j < Tile; ++j) sums[i][j] += of_a * of_b[j];
    }
  }
  Products<Tile> result;
  for (std::size_t i = 0; i < Tile; ++i)
    for (std::size_t j = 0; j < Tile; ++j) result[i][j] = sum_of(sums[i][j]);
  return result;
}

}  // namespace

RowProducts::RowProducts(std::size_t rows, std::size_t columns)
    : rows_(rows), columns_(columns), values_((rows + tile - 1) / tile * tile * columns) {}

void RowProducts::add_to(std::span<double> sums, std::size_t columns) const {
  const auto from = [&](std::size_t row) { return values_.data() + row * columns_; };
  for (std::size_t below = 0; below < rows_; below += tile)
    for (std::size_t above = 0; above <= below; above += tile) {
      const auto found = products<tile>(from(below), from(above), columns_, columns);
      for (std::size_t i = 0; i < tile && below + i < rows_; ++i)
        for (std::size_t j = 0; j < tile && above + j <= below + i; ++j)
          sums[(above + j) * rows_ + below + i] += found[i][j];
    }
}

}  // namespace fabseq
