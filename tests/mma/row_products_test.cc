// SPDX-License-Identifier: MIT
/// Products of rows in registers against sums one by one.
#include "mma/row_products.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fabseq {
namespace {

double entry(std::size_t row, std::size_t column) {
  return std::sin(1.0 + 3.7 * static_cast<double>(row) + 0.31 * static_cast<double>(column * (row + 1)));
}

TEST(RowProductsTest, AddsAllProductsToTheLowerTriangle) {
  constexpr std::size_t columns = 4 * RowProducts::column_step;
  for (const std::size_t rows : {1, 2, 3, 4, 5, 8, 27})
    for (const std::size_t used : {RowProducts::column_step, columns}) {
      RowProducts products(rows, columns);
      for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column)
          products.row(row)[column] = entry(row, column);
      std::vector<double> sums(rows * rows, 2.0);
      products.add_to(sums, used);
      for (std::size_t above = 0; above < rows; ++above)
        for (std::size_t below = 0; below < rows; ++below) {
          double expected = 2.0;
          for (std::size_t column = 0; below >= above && column < used; ++column)
            expected += entry(above, column) * entry(below, column);
          EXPECT_NEAR(sums[above * rows + below], expected, 1e-12) << rows << ' ' << above << ' ' << below;
        }
    }
}

}  // namespace
}  // namespace fabseq
