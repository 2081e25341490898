// SPDX-License-Identifier: MIT
/// \file
/// Rigid motions of points, and least-squares fits of them to displacements.
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/grid/index_box.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fabseq {

/// Number of independent rigid motions. Translations come first, followed by rotations.
template <int Dim>
constexpr int rigid_motion_count = Dim*(Dim + 1) / 2;

/// Displacement component of rigid motion `number` at a position. Rotations are linear, about the origin, by
/// a unit angle.
template <int Dim>
double rigid_motion(int number, int component, const Point<Dim>& position) {
  if (number < Dim) return number == component ? 1.0 : 0.0;
  const int a = Dim == 2 ? 0 : (number - Dim + 1) % Dim;
  const int b = Dim == 2 ? 1 : (number - Dim + 2) % Dim;
  if (component == a) return -position[b];
  return component == b ? position[a] : 0.0;
}

/// The normal matrix R^T W R of the rigid motions R at a set of displacement components, with diagonal
/// weights W.
template <int Dim>
class RigidFit {
 public:
  static constexpr int count = rigid_motion_count<Dim>;
  /// One factor per rigid motion.
  using Amplitudes = std::array<double, count>;

  /// Adds one displacement component of the point at `position` to the matrix. Local.
  void add(const Point<Dim>& position, int component, double weight = 1.0) {
    for (int k = 0; k < count; ++k)
      for (int l = 0; l <= k; ++l)
        matrix_[k * count + l] +=
            weight * rigid_motion<Dim>(k, component, position) * rigid_motion<Dim>(l, component, position);
  }
  /// Sums the matrices of all ranks. Collective on `comm`.
  void sum(MPI_Comm comm) { sum_in_place(comm, matrix_); }

  /// Replaces the matrix by its Cholesky factor. Returns false if a motion depends on those before it: its
  /// pivot is at most `least`, or at most `share` times its diagonal entry.
  bool factor(double share, double least = 0.0) {
    for (int row = 0; row < count; ++row) {
      const double limit = std::max(least, share * matrix_[row * count + row]);
      for (int column = 0; column <= row; ++column) {
        double& value = matrix_[row * count + column];
        for (int k = 0; k < column; ++k) value -= matrix_[row * count + k] * matrix_[column * count + k];
        if (column < row)
          value /= matrix_[column * count + column];
        else if (value > limit)
          value = std::sqrt(value);
        else
          return false;
      }
    }
    return true;
  }
  /// (R^T W R)^-1 times `right`. Needs a successful factor().
  Amplitudes solve(Amplitudes right) const {
    for (int row = 0; row < count; ++row) {
      for (int k = 0; k < row; ++k) right[row] -= matrix_[row * count + k] * right[k];
      right[row] /= matrix_[row * count + row];
    }
    for (int row = count - 1; row >= 0; --row) {
      for (int k = row + 1; k < count; ++k) right[row] -= matrix_[k * count + row] * right[k];
      right[row] /= matrix_[row * count + row];
    }
    return right;
  }

 private:
  std::array<double, static_cast<std::size_t>(count) * count> matrix_{};  ///< lower triangle
};

}  // namespace fabseq
