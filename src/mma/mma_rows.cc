// SPDX-License-Identifier: MIT
#include "fabseq/base/blas.h"
#include "mma/mma_row_newton.h"
#include "mma/mma_subproblem.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fabseq {

namespace {

constexpr int step_limit = 100;
constexpr double product_tolerance = 1e-14, residual_tolerance = 1e-12;  // over the size of b
constexpr double to_the_boundary = 0.995;                                // fraction of the way
constexpr double neighborhood = 1e-4;                                    // least product over the mean
constexpr double far_residual = 1e-6, long_step = 0.3;
constexpr double rounding = 1e-15;
constexpr double least_size = 1e-8;  // of a start value

class RowModel {
 public:
  RowModel(std::span<const double> matrix, std::size_t stride, std::span<const double> right,
           const MmaRows& rows)
      : m_(right.size()),
        right_(right),
        rows_(rows),
        newton_(matrix, stride, right, rows),
        point_(m_),
        predictor_(m_),
        direction_(m_) {}

  MmaMultipliers solve();

 private:
  void start();
  struct Products {
    double mean = 0.0, least = std::numeric_limits<double>::infinity();
  };
  Products products(const MmaRowPoint& direction, double t) const;
  bool good(const MmaRowPoint& direction, double t, double mean) const;
  double choose_direction(double mean);
  double largest_step(const MmaRowPoint& direction);

  std::size_t m_;
  std::span<const double> right_;
  const MmaRows& rows_;
  MmaRowNewton newton_;
  MmaRowPoint point_, predictor_, direction_;
  double size_ = 0.0;  // of b
};

void RowModel::start() {
  for (std::size_t i = 0; i < m_; ++i) {
    const double diagonal = newton_.diagonal(i);
    const double size = std::max(std::abs(right_[i]), least_size);
    const double most = rows_.c[i] + rows_.d[i] * size;
    point_.lambda[i] = std::clamp(size / std::max(diagonal, 1e-100), 1e-6 * most, most);
    point_.slack[i] = size;
    // Without c, y is lambda / d and no more: two numbers that both vanish would only slow things down.
    point_.y[i] = rows_.c[i] > 0.0 ? size : point_.lambda[i] / rows_.d[i];
    point_.mu[i] = rows_.c[i] > 0.0 ? most : 0.0;
  }
  if (newton_.has_z()) {
    point_.zeta = rows_.a0;
    point_.z = least_size;
    for (std::size_t i = 0; i < m_; ++i) point_.z = std::max(point_.z, std::abs(right_[i]));
  }
}

RowModel::Products RowModel::products(const MmaRowPoint& direction, double t) const {
  Products result;
  double sum = 0.0;
  int count = 0;
  const auto add = [&](double first, double second) {
    sum += first * second;
    result.least = std::min(result.least, first * second);
    ++count;
  };
  for (std::size_t i = 0; i < m_; ++i) {
    add(point_.lambda[i] + t * direction.lambda[i], point_.slack[i] + t * direction.slack[i]);
    if (rows_.c[i] <= 0.0) continue;
    add(point_.y[i] + t * direction.y[i], point_.mu[i] + t * direction.mu[i]);
  }
  if (newton_.has_z()) add(point_.z + t * direction.z, point_.zeta + t * direction.zeta);
  result.mean = sum / count;
  return result;
}

double RowModel::largest_step(const MmaRowPoint& direction) {
  double rate = 0.0;
  point_.visit(direction, [&rate](double value, double change) {
    if (change < 0.0) rate = std::max(rate, -change / value);
  });
  return rate > 1.0 ? 1.0 / rate : 1.0;
}

// Whether a step keeps all products near their mean and makes the mean smaller; far from the solution, where
// the products may have to grow, whether it is long.
bool RowModel::good(const MmaRowPoint& direction, double t, double mean) const {
  const auto [next, least] = products(direction, t);
  const bool far = newton_.largest_residual(size_) > far_residual * size_ && t > long_step;
  return least >= neighborhood * next && (far || next <= (1.0 - 0.01 * t) * mean);
}

// Mehrotra's direction if it is good, else one that aims nearer to the middle. Returns the step.
double RowModel::choose_direction(double mean) {
  newton_.set_direction(point_, 0.0, nullptr, predictor_);
  const double reached = products(predictor_, largest_step(predictor_)).mean / mean;
  newton_.set_direction(point_, std::pow(std::max(reached, 0.0), 3) * mean, &predictor_, direction_);
  double t = std::min(1.0, to_the_boundary * largest_step(direction_));
  if (good(direction_, t, mean)) return t;
  for (const double part : {0.1, 0.5}) {
    newton_.set_direction(point_, part * mean, nullptr, direction_);
    const double longest = std::min(1.0, to_the_boundary * largest_step(direction_));
    for (t = longest; t > 0.3 * longest; t *= 0.7) {
      if (good(direction_, t, mean)) return t;
    }
    t = longest;
  }
  return t;
}

MmaMultipliers RowModel::solve() {
  size_ = least_size;
  for (const double value : right_) size_ = std::max(size_, std::abs(value));
  start();
  const MmaRowPoint zero(m_);
  for (int step = 0; step < step_limit; ++step) {
    newton_.set_residuals(point_);
    double terms = size_;  // what rounding is a part of
    for (std::size_t i = 0; i < m_; ++i) terms = std::max(terms, newton_.diagonal(i) * point_.lambda[i]);
    const double mean = products(zero, 0.0).mean;
    const double enough = std::max(residual_tolerance * size_, rounding * terms);
    if ((newton_.largest_residual(size_) <= enough && mean <= product_tolerance * size_) ||
        !newton_.factorize(point_))
      break;
    const double t = choose_direction(mean);
    point_.visit(direction_, [t](double& value, double change) { value += t * change; });
  }
  return {point_.lambda, point_.y, point_.z};
}

}  // namespace

MmaMultipliers solve_row_model(std::span<const double> matrix, std::size_t stride,
                               std::span<const double> right, const MmaRows& rows,
                               std::span<const double> least) {
  if (right.empty()) return {};
  // In terms of lambda - least the least multipliers are 0.
  const auto m = static_cast<int>(right.size()), lead = static_cast<int>(stride);
  const int one = 1;
  const double minus = -1.0, plus = 1.0;
  MmaRows shifted = rows;
  std::vector<double> rest(right.begin(), right.end());
  dsymv_("L", &m, &minus, matrix.data(), &lead, least.data(), &one, &plus, rest.data(), &one);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    shifted.a0 -= rows.a[i] * least[i];
    if (rows.c[i] > 0.0) {
      shifted.c[i] -= least[i];
    } else {
      rest[i] -= least[i] / rows.d[i];  // y = lambda / d
    }
  }
  MmaMultipliers result = RowModel(matrix, stride, rest, shifted).solve();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    result.lambda[i] += least[i];
    if (rows.c[i] <= 0.0) result.y[i] += least[i] / rows.d[i];
  }
  return result;
}

}  // namespace fabseq
