// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/lane_array.h"
#include "kernels/lanes.h"
#include "multigrid/band_cholesky.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace fabseq {

/// A band matrix's Cholesky factor L, arranged for many solves: eight columns side by side make a panel, so
/// that the unknowns pass through the registers once for eight columns; a panel ends with its last number
/// that is not zero. `Real`: of the numbers kept; sums are in double precision. Half the bytes of a factor in
/// double precision are half the time, as the factor does not fit into the caches near the core. L L^T stays
/// symmetric and positive definite when L is rounded.
template <class Real>
class BandFactor {
 public:
  /// `factored`: a matrix after its factor() has succeeded.
  explicit BandFactor(const BandCholesky& factored);

  /// Rows that a vector must have room for, those behind the matrix's own being zero.
  static std::size_t padded(int size, int bandwidth) { return (panels(size) + panels(bandwidth)) * panel; }
  /// Solves in place: `values` is [row][lane], padded, on a cache line.
  template <int Width>
  void solve(double* values) const;

 private:
  static constexpr std::size_t panel = 8;
  static std::size_t panels(std::size_t size) { return (size + panel - 1) / panel; }
  /// Returns the place of a panel: its triangle's inverse by columns, then by rows, then what is below the
  /// triangle, as squares of eight rows and columns; squares are stored by columns.
  const Real* place(std::size_t number) const { return &values_[starts_[number]]; }
  /// Where an entry is among those below a triangle.
  static constexpr std::size_t below(std::size_t row, std::size_t column) {
    return (row / panel * panel + column) * panel + row % panel;
  }
  /// Rows of a panel below its triangle, up to the square with the last that is not zero.
  std::size_t rows_below(std::size_t number) const {
    return (starts_[number + 1] - starts_[number]) / panel - 2 * panel;
  }
  void invert_triangle(const BandCholesky& factored, std::size_t first, Real* to) const;
  template <int Width>
  static std::array<Lanes<Width>, panel> times_triangle(const Real* triangle,
                                                        const std::array<Lanes<Width>, panel>& values);
  void solve_one(double* values) const;

  std::size_t panels_;
  std::vector<std::size_t> starts_;  ///< of each panel in the values, and the end
  LaneValues<Real> values_;
};

template <class Real>
BandFactor<Real>::BandFactor(const BandCholesky& factored) : panels_(panels(factored.size())), starts_{0} {
  const int size = factored.size();
  for (int first = 0; first < size; first += panel) {
    int last = first + static_cast<int>(panel) - 1;
    for (int column = first; column < std::min(first + static_cast<int>(panel), size); ++column)
      last = std::max(last, factored.last_row(column));
    starts_.push_back(starts_.back() + (2 * panel + panels(last - first + 1 - panel) * panel) * panel);
  }
  values_.resize(starts_.back());
  for (std::size_t number = 0; number < panels_; ++number) {
    Real* const to = &values_[starts_[number]];
    const std::size_t first = number * panel;
    invert_triangle(factored, first, to);
    for (std::size_t k = 0; k < panel; ++k)
      for (std::size_t row = 0; row < rows_below(number); ++row)
        to[2 * panel * panel + below(row, k)] = static_cast<Real>(
            factored.entry(static_cast<int>(first + panel + row), static_cast<int>(first + k)));
  }
}

/// Rows behind the last one are those of a unit matrix.
template <class Real>
void BandFactor<Real>::invert_triangle(const BandCholesky& factored, std::size_t first, Real* to) const {
  std::array<std::array<double, panel>, panel> inverse{};  // [column][row]
  const auto entry = [&](std::size_t row, std::size_t column) {
    if (first + row < static_cast<std::size_t>(factored.size()))
      return factored.entry(static_cast<int>(first + row), static_cast<int>(first + column));
    return row == column ? 1.0 : 0.0;
  };
  for (std::size_t column = 0; column < panel; ++column)
    for (std::size_t row = column; row < panel; ++row) {
      double sum = row == column ? 1.0 : 0.0;
      for (std::size_t k = column; k < row; ++k) sum -= entry(row, k) * inverse[column][k];
      inverse[column][row] = sum / entry(row, row);
      to[column * panel + row] = to[(panel + row) * panel + column] = static_cast<Real>(inverse[column][row]);
    }
}

/// Sum of the triangle's eight columns, times a value each.
template <class Real>
template <int Width>
std::array<Lanes<Width>, BandFactor<Real>::panel> BandFactor<Real>::times_triangle(
    const Real* triangle, const std::array<Lanes<Width>, panel>& values) {
  std::array<Lanes<Width>, panel> sums;
  sums.fill(Lanes<Width>::zero());
  for (std::size_t k = 0; k < panel; ++k)
    for (std::size_t row = 0; row < panel; ++row)
      sums[row] += values[k] * static_cast<double>(triangle[k * panel + row]);
  return sums;
}

template <class Real>
template <int Width>
void BandFactor<Real>::solve(double* values) const {
  if constexpr (Width == 1) {
    solve_one(values);
  } else {
    using Value = Lanes<Width>;
    const auto at = [&](std::size_t row) { return values + row * Width; };
    std::array<Value, panel> own;
    for (std::size_t number = 0; number < panels_; ++number) {
      const Real* const from = place(number);
      const Real* const squares = from + 2 * panel * panel;
      for (std::size_t k = 0; k < panel; ++k) own[k] = Value::load(at(number * panel + k));
      own = times_triangle<Width>(from, own);
      for (std::size_t k = 0; k < panel; ++k) own[k].store(at(number * panel + k));
      for (std::size_t row = 0; row < rows_below(number); ++row) {
        auto value = Value::load(at((number + 1) * panel + row));
        const Real* const numbers = squares + below(row, 0);
        for (std::size_t k = 0; k < panel; ++k)
          value = value - own[k] * static_cast<double>(numbers[k * panel]);
        value.store(at((number + 1) * panel + row));
      }
    }
    for (std::size_t number = panels_; number-- > 0;) {
      const Real* const from = place(number);
      const Real* const squares = from + 2 * panel * panel;
      for (std::size_t k = 0; k < panel; ++k) own[k] = Value::load(at(number * panel + k));
      for (std::size_t row = 0; row < rows_below(number); ++row) {
        const auto value = Value::load(at((number + 1) * panel + row));
        const Real* const numbers = squares + below(row, 0);
        for (std::size_t k = 0; k < panel; ++k)
          own[k] = own[k] - value * static_cast<double>(numbers[k * panel]);
      }
      own = times_triangle<Width>(from + panel * panel, own);
      for (std::size_t k = 0; k < panel; ++k) own[k].store(at(number * panel + k));
    }
  }
}

/// The same for one lane, with the rows of a panel in the lanes of registers.
template <class Real>
void BandFactor<Real>::solve_one(double* values) const {
  using Rows = Lanes<static_cast<int>(panel)>;
  const auto times = [](const Real* triangle, const std::array<double, panel>& own) {
    std::array<Rows, 2> sums{Rows::zero(), Rows::zero()};  // side by side: each waits for itself only
    for (std::size_t k = 0; k < panel; ++k) sums[k % 2] += Rows::load(triangle + k * panel) * own[k];
    return sums[0] + sums[1];
  };
  std::array<double, panel> own;
  for (std::size_t number = 0; number < panels_; ++number) {
    const Real* const from = place(number);
    const Real* const squares = from + 2 * panel * panel;
    double* const here = values + number * panel;
    std::copy_n(here, panel, own.begin());
    times(from, own).store(own.data());
    std::copy_n(own.begin(), panel, here);
    for (std::size_t row = 0; row < rows_below(number); row += panel) {
      auto value = Rows::load(here + panel + row);
      for (std::size_t k = 0; k < panel; ++k) value = value - Rows::load(squares + below(row, k)) * own[k];
      value.store(here + panel + row);
    }
  }
  for (std::size_t number = panels_; number-- > 0;) {
    const Real* const from = place(number);
    const Real* const squares = from + 2 * panel * panel;
    double* const here = values + number * panel;
    std::array<Rows, panel> sums;
    sums.fill(Rows::zero());
    for (std::size_t row = 0; row < rows_below(number); row += panel) {
      const auto value = Rows::load(here + panel + row);
      for (std::size_t k = 0; k < panel; ++k) sums[k] += Rows::load(squares + below(row, k)) * value;
    }
    for (std::size_t k = 0; k < panel; ++k) {
      own[k] = here[k];
      for (std::size_t lane = 0; lane < panel; ++lane) own[k] -= sums[k][static_cast<int>(lane)];
    }
    times(from + panel * panel, own).store(here);
  }
}

}  // namespace fabseq
