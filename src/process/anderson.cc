// SPDX-License-Identifier: MIT
#include "process/anderson.h"

#include "fabseq/base/blas.h"
#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Share of the largest diagonal entry that is added to all of the normal equations: it keeps steps that
/// hardly differ from weighing much.
constexpr double regularization = 1e-12;

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
  // Steps that rounding makes dependent are not combined.
  const int size = static_cast<int>(count), one = 1;
  int failed = 0;
  if (count > 0) dposv_("L", &size, &one, matrix.data(), &size, right.data(), &size, &failed);
  if (failed != 0) std::ranges::fill(right, 0.0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] += step[i];
    for (std::size_t k = 0; k < count; ++k) x[i] -= right[k] * (x_changes_[k][i] + step_changes_[k][i]);
  }
}

}  // namespace fabseq
