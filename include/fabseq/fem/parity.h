// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"

#include <array>

namespace fabseq {

/// A symmetric element matrix that commutes with the reflections of the box (isotropic stiffness,
/// conductivity, mass) in the basis of products of even and odd combinations of its corners: mode s of a
/// component is sum over corners n of (-1)^|s & n| value_n. There the matrix falls apart into one small block
/// per parity class r: component a of a vector takes the mode r xor 2^a, a scalar the mode r.
template <int Dim, int Components>
struct ParityMatrix {
  static constexpr int classes = corner_count<Dim>;
  static constexpr int unknowns = Components * corner_count<Dim>;

  /// Blocks for modes without normalization: K = sum over classes of modes^T block modes.
  std::array<std::array<std::array<double, Components>, Components>, classes> blocks{};

  ParityMatrix() = default;
  explicit ParityMatrix(const SquareMatrix<unknowns>& matrix);

  /// Mode that `component` contributes to a class.
  static constexpr int mode(int parity_class, int component) {
    return Components == 1 ? parity_class : parity_class ^ (1 << component);
  }
  /// Whether a block entry can differ from zero for elasticity of a box: rigid translations carry no energy,
  /// and components couple only where their parities agree.
  static constexpr bool couples(int parity_class, int a, int b) {
    if (Components == 1) return true;
    if (a == b) return parity_class != (1 << a);
    return ((parity_class >> a) & 1) == ((parity_class >> b) & 1);
  }
};

/// Largest eigenvalue of D^-1 K for an element matrix K and the block diagonal D of its corner blocks (each
/// `components` wide): bounds the spectrum of the assembled, likewise scaled operator whatever the
/// coefficients of the elements are.
double scaled_spectrum_bound(std::span<const double> matrix, int corners, int components);

}  // namespace fabseq
