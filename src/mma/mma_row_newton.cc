// SPDX-License-Identifier: MIT
#include "mma/mma_row_newton.h"

#include "fabseq/base/blas.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fabseq {

namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

MmaRowNewton::MmaRowNewton(std::span<const double> matrix, std::size_t stride, std::span<const double> right,
                           const MmaRows& rows)
    : m_(right.size()),
      matrix_(matrix),
      stride_(static_cast<int>(stride)),
      right_(right),
      rows_(rows),
      has_z_(std::any_of(rows.a.begin(), rows.a.end(), [](double a) { return a != 0.0; })),
      row_(m_),
      elastic_(m_),
      scale_(m_) {}

void MmaRowNewton::set_residuals(const MmaRowPoint& point) {
  const auto m = static_cast<int>(m_);
  const int one = 1;
  const double minus = -1.0, plus = 1.0;
  std::copy(right_.begin(), right_.end(), row_.begin());
  dsymv_("L", &m, &minus, matrix_.data(), &stride_, point.lambda.data(), &one, &plus, row_.data(), &one);
  for (std::size_t i = 0; i < m_; ++i) {
    row_[i] += point.slack[i] - rows_.a[i] * point.z - point.y[i];
    elastic_[i] = rows_.c[i] + rows_.d[i] * point.y[i] - point.mu[i] - point.lambda[i];
  }
  pull_ = has_z_ ? rows_.a0 - point.zeta - dot(rows_.a, point.lambda) : 0.0;
}

double MmaRowNewton::largest_residual(double size) const {
  double largest = std::abs(pull_) / (1.0 + rows_.a0);
  for (std::size_t i = 0; i < m_; ++i)
    largest = std::max(largest, std::abs(elastic_[i]) / (1.0 + rows_.c[i]));
  largest *= size;
  for (const double residual : row_) largest = std::max(largest, std::abs(residual));
  return largest;
}

// Cholesky factors of H + s / lambda + 1 / (d + mu / y) with unit diagonal; should rounding have made it
// indefinite, with the diagonal raised.
bool MmaRowNewton::factorize(const MmaRowPoint& point) {
  const auto m = static_cast<int>(m_);
  for (double raise = 0.0; raise < 1.0; raise = std::max(1e-14, 100.0 * raise)) {
    factor_.assign(m_ * m_, 0.0);
    for (std::size_t i = 0; i < m_; ++i) {
      const double own = point.slack[i] / point.lambda[i] + 1.0 / (rows_.d[i] + point.mu[i] / point.y[i]);
      scale_[i] = 1.0 / std::sqrt(diagonal(i) + own);
      factor_[i * m_ + i] = own;
    }
    for (std::size_t i = 0; i < m_; ++i) {
      for (std::size_t k = i; k < m_; ++k) {
        factor_[i * m_ + k] += matrix_[i * static_cast<std::size_t>(stride_) + k];
        factor_[i * m_ + k] *= scale_[i] * scale_[k];
      }
      factor_[i * m_ + i] += raise;
    }
    int info = 0;
    dpotrf_("L", &m, factor_.data(), &m, &info);
    if (info != 0) continue;
    if (has_z_) {
      solved_a_ = rows_.a;
      backsolve(solved_a_);
    }
    return true;
  }
  return false;
}

void MmaRowNewton::backsolve(std::vector<double>& vector) const {
  const auto m = static_cast<int>(m_);
  const int one = 1;
  int info = 0;
  for (std::size_t i = 0; i < m_; ++i) vector[i] *= scale_[i];
  dpotrs_("L", &m, &one, factor_.data(), &m, vector.data(), &m, &info);
  for (std::size_t i = 0; i < m_; ++i) vector[i] *= scale_[i];
}

void MmaRowNewton::set_direction(const MmaRowPoint& point, double target, const MmaRowPoint* second_order,
                                 MmaRowPoint& direction) const {
  const auto wanted = [target](double first, double second, double first_change, double second_change) {
    return target - first * second - first_change * second_change;
  };
  const MmaRowPoint zero(m_);
  const MmaRowPoint& before = second_order == nullptr ? zero : *second_order;
  std::vector<double> slack_wanted(m_), mu_wanted(m_);
  for (std::size_t i = 0; i < m_; ++i) {
    slack_wanted[i] = wanted(point.lambda[i], point.slack[i], before.lambda[i], before.slack[i]);
    mu_wanted[i] = rows_.c[i] > 0.0 ? wanted(point.y[i], point.mu[i], before.y[i], before.mu[i]) : 0.0;
    const double shift = mu_wanted[i] / point.y[i] - elastic_[i];
    direction.lambda[i] =
        row_[i] + slack_wanted[i] / point.lambda[i] - shift / (rows_.d[i] + point.mu[i] / point.y[i]);
  }
  backsolve(direction.lambda);
  if (has_z_) {
    const double z_wanted = wanted(point.z, point.zeta, before.z, before.zeta);
    direction.z = (dot(rows_.a, direction.lambda) - pull_ + z_wanted / point.z) /
                  (dot(rows_.a, solved_a_) + point.zeta / point.z);
    for (std::size_t i = 0; i < m_; ++i) direction.lambda[i] -= solved_a_[i] * direction.z;
    direction.zeta = (z_wanted - point.zeta * direction.z) / point.z;
  }
  for (std::size_t i = 0; i < m_; ++i) {
    const double shift = mu_wanted[i] / point.y[i] - elastic_[i];
    direction.y[i] = (direction.lambda[i] + shift) / (rows_.d[i] + point.mu[i] / point.y[i]);
    direction.mu[i] = (mu_wanted[i] - point.mu[i] * direction.y[i]) / point.y[i];
    direction.slack[i] = (slack_wanted[i] - point.slack[i] * direction.lambda[i]) / point.lambda[i];
  }
}

}  // namespace fabseq
