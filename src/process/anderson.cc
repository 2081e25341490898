// SPDX-License-Identifier: MIT
#include "process/anderson.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Share of the largest diagonal entry that is added to all of the normal equations: it keeps steps that
/// hardly differ from weighing much.
constexpr double regularization = 1e-12;

/// Solves a symmetric positive system by elimination; `matrix` row by row.
std::vector<double> solved(std::vector<double> matrix, std::vector<double> right) {
  const std::size_t n = right.size();
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = matrix[i * n + k] / matrix[k * n + k];
      for (std::size_t j = k; j < n; ++j) matrix[i * n + j] -= factor * matrix[k * n + j];
      right[i] -= factor * right[k];
    }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) right[k] -= matrix[k * n + j] * right[j];
    right[k] /= matrix[k * n + k];
  }
  return right;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

}  // namespace

double Anderson::product(std::span<const double> a, std::span<const double> b) const {
  double result = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) result += weights_[i] * a[i] * b[i];
  return result;
}

double Anderson::norm(std::span<const double> values) const {
  return std::sqrt(sum(comm_, product(values, values)));
}

void Anderson::advance(std::vector<double>& x, const std::vector<double>& step) {
  if (!last_x_.empty()) {
    x_changes_.push_back(difference(x, last_x_));
    step_changes_.push_back(difference(step, last_step_));
    if (x_changes_.size() > depth_) {
      x_changes_.pop_front();
      step_changes_.pop_front();
    }
  }
  last_x_ = x;
  last_step_ = step;
  const std::size_t count = x_changes_.size();
  std::vector<double> sums;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) sums.push_back(product(step_changes_[i], step_changes_[j]));
    sums.push_back(product(step_changes_[i], step));
  }
  sum_in_place(comm_, std::span<double>(sums));
  std::vector<double> matrix(count * count), right(count);
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) matrix[i * count + j] = sums[i * (count + 1) + j];
    right[i] = sums[i * (count + 1) + count];
    largest = std::max(largest, matrix[i * count + i]);
  }
  for (std::size_t i = 0; i < count; ++i) matrix[i * count + i] += regularization * largest;
  const std::vector<double> factors = largest > 0.0 ? solved(matrix, right) : std::vector<double>(count, 0.0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] += step[i];
    for (std::size_t k = 0; k < count; ++k) x[i] -= factors[k] * (x_changes_[k][i] + step_changes_[k][i]);
  }
}

}  // namespace fabseq
