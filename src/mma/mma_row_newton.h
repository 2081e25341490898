// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/mma/mma.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// Everything in the row model that must stay positive, or its directions: row i has lambda, s, y,
/// mu = c + d y - lambda; then z, zeta.
struct MmaRowPoint {
  std::vector<double> lambda, slack, y, mu;
  double z = 0.0, zeta = 0.0;

  explicit MmaRowPoint(std::size_t m) : lambda(m), slack(m), y(m), mu(m) {}

  /// Calls visit_pair(own entry, entry of other) for all of them.
  template <class Visit>
  void visit(const MmaRowPoint& other, Visit&& visit_pair) {
    for (std::size_t i = 0; i < lambda.size(); ++i) {
      visit_pair(lambda[i], other.lambda[i]);
      visit_pair(slack[i], other.slack[i]);
      visit_pair(y[i], other.y[i]);
      visit_pair(mu[i], other.mu[i]);
    }
    visit_pair(z, other.z);
    visit_pair(zeta, other.zeta);
  }
};

/// Newton's method for the conditions of solve_row_model(): these linearized at a point, which it is handed.
/// Arguments as of solve_row_model(), borrowed.
class MmaRowNewton {
 public:
  MmaRowNewton(std::span<const double> matrix, std::size_t stride, std::span<const double> right,
               const MmaRows& rows);

  /// Whether any a_i is not 0; z and zeta are left out otherwise.
  bool has_z() const { return has_z_; }
  /// H_ii.
  double diagonal(std::size_t i) const { return matrix_[i * static_cast<std::size_t>(stride_) + i]; }

  /// Residuals of the linear equations at a point, for the directions and largest_residual().
  void set_residuals(const MmaRowPoint& point);
  /// Largest of them; `size` is what rows are measured with. The equations in multipliers have a size of
  /// their own, and rounding keeps their residuals from becoming as small as that of the rows may be.
  double largest_residual(double size) const;

  /// Factors the matrix of the directions at a point; false if it is beyond repair.
  bool factorize(const MmaRowPoint& point);
  /// Newton's direction to where all products are `target`, with the products of the changes `second_order`,
  /// a predictor's, taken away (nullptr: none).
  void set_direction(const MmaRowPoint& point, double target, const MmaRowPoint* second_order,
                     MmaRowPoint& direction) const;

 private:
  void backsolve(std::vector<double>& vector) const;

  std::size_t m_;
  std::span<const double> matrix_;
  int stride_;
  std::span<const double> right_;
  const MmaRows& rows_;
  bool has_z_;
  std::vector<double> row_, elastic_;  // residuals of the rows and of mu's equation
  double pull_ = 0.0;                  // residual of zeta's equation
  std::vector<double> scale_, factor_, solved_a_;
};

}  // namespace fabseq
