// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"
#include "fabseq/sequence/sequence.h"

#include <cmath>

namespace fabseq {

/// The build direction of curved layers, grad t / sqrt(|grad t|^2 + eps^2) (docs/formulation.md 13.2), with
/// its derivative with respect to grad t.
template <int Dim>
struct UnitGradient {
  UnitGradient() = default;
  UnitGradient(const double* gradient, double characteristic_length) {
    double square = gradient_regularization(characteristic_length);
    for (int i = 0; i < Dim; ++i) square += gradient[i] * gradient[i];
    length = std::sqrt(square);
    for (int i = 0; i < Dim; ++i) vector[i] = gradient[i] / length;
  }

  /// Adds the derivative with respect to grad t to Dim entries. \param d_vector  dJ/d(vector)
  void add_derivative(const Point<Dim>& d_vector, double* d_gradient) const {
    double along = 0.0;
    for (int i = 0; i < Dim; ++i) along += d_vector[i] * vector[i];
    for (int i = 0; i < Dim; ++i) d_gradient[i] += (d_vector[i] - along * vector[i]) / length;
  }

  Point<Dim> vector{};
  double length = 1.0;  ///< regularized |grad t|, 1/length
};

}  // namespace fabseq
