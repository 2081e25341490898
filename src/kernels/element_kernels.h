// SPDX-License-Identifier: MIT
/// \file
/// One element of the lane kernels: from the modes of its two faces across x to its forces on them.
#pragma once

#include "fabseq/fem/parity.h"
#include "kernels/lanes.h"

#include <array>
#include <cstdint>

namespace fabseq {

/// Even and odd combinations of the values at a face's corners, [component][mode]; in registers.
template <int Dim, int Components, int Width, class Real = double>
using FaceModes = std::array<std::array<Lanes<Width, Real>, corner_count<Dim> / 2>, Components>;

/// Elasticity with one stiffness factor per element and lane. Computes in `Real`.
template <int Dim, int Width, class Real = double>
class ElasticKernel {
 public:
  static constexpr int dim = Dim;
  static constexpr int components = Dim;
  static constexpr int width = Width;
  using Number = Real;
  /// Coefficients per element in memory: [element][lane].
  static constexpr int stride = Width;
  /// Modes of the faces of so many elements.
  template <int Count>
  using Modes = FaceModes<Dim, components, Count * Width, Real>;

  /// `coefficients` must outlive the kernel.
  ElasticKernel(const ParityMatrix<Dim, Dim>& matrix, const Real* coefficients)
      : coefficients_(coefficients) {
    for (int parity_class = 0; parity_class < corner_count<Dim>; ++parity_class)
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b)
          blocks_[parity_class][a][b] = static_cast<Real>(matrix.blocks[parity_class][a][b]);
  }

  void prefetch(std::int64_t element) const { __builtin_prefetch(coefficients_ + element * stride); }

  /// Sets the forces of `Count` elements, that follow each other along x, on their lower and upper faces.
  template <int Count>
  [[gnu::always_inline]] void apply(std::int64_t element, const Modes<Count>& lower,
                                    const Modes<Count>& upper, Modes<Count>& lower_forces,
                                    Modes<Count>& upper_forces) const {
    using Value = Lanes<Count * Width, Real>;
    const auto factor = Value::load(coefficients_ + element * stride);
#pragma GCC unroll 4
    for (int face_class = 0; face_class < corner_count<Dim> / 2; ++face_class) {
      std::array<Value, Dim> even, odd;
#pragma GCC unroll 3
      for (int a = 0; a < Dim; ++a) {
        even[a] = lower[a][face_mode(face_class, a)] + upper[a][face_mode(face_class, a)];
        odd[a] = lower[a][face_mode(face_class, a)] - upper[a][face_mode(face_class, a)];
      }
      // Class 2 f holds the odd modes of component 0 and the even ones of the others, class 2 f + 1 the rest.
      std::swap(even[0], odd[0]);
      std::array<Value, Dim> first, second;
#pragma GCC unroll 3
      for (int a = 0; a < Dim; ++a) {
        first[a] = factor * row(2 * face_class, a, even);
        second[a] = factor * row(2 * face_class + 1, a, odd);
      }
#pragma GCC unroll 3
      for (int a = 0; a < Dim; ++a) {
        lower_forces[a][face_mode(face_class, a)] = first[a] + second[a];
        upper_forces[a][face_mode(face_class, a)] = a == 0 ? second[a] - first[a] : first[a] - second[a];
      }
    }
  }

 private:
  /// Mode within a face that a component contributes to a class.
  static constexpr int face_mode(int face_class, int component) {
    return component == 0 ? face_class : face_class ^ (1 << (component - 1));
  }
  template <class Value>
  [[gnu::always_inline]] Value row(int parity_class, int a, const std::array<Value, Dim>& modes) const {
    auto sum = Value::zero();
    bool empty = true;
#pragma GCC unroll 3
    for (int b = 0; b < Dim; ++b) {
      if (!ParityMatrix<Dim, Dim>::couples(parity_class, a, b)) continue;
      const Value term = modes[b] * blocks_[parity_class][a][b];
      sum = empty ? term : sum + term;
      empty = false;
    }
    return sum;
  }

  std::array<std::array<std::array<Real, Dim>, Dim>, corner_count<Dim>> blocks_;
  const Real* coefficients_;
};

/// Conduction plus reaction with two coefficients per element that all lanes share: the lanes are right-hand
/// sides of one system. Computes in `Real`.
template <int Dim, int Width, class Real = double>
class HeatKernel {
 public:
  static constexpr int dim = Dim;
  static constexpr int components = 1;
  static constexpr int width = Width;
  using Number = Real;
  /// Coefficients per element in memory: diffusivity, reaction.
  static constexpr int stride = 2;
  template <int Count>
  using Modes = FaceModes<Dim, components, Count * Width, Real>;

  /// `coefficients` must outlive the kernel.
  HeatKernel(const ParityMatrix<Dim, 1>& conductivity, const ParityMatrix<Dim, 1>& mass,
             const Real* coefficients)
      : coefficients_(coefficients) {
    for (int mode = 0; mode < corner_count<Dim>; ++mode) {
      conductivity_[mode] = static_cast<Real>(conductivity.blocks[mode][0][0]);
      mass_[mode] = static_cast<Real>(mass.blocks[mode][0][0]);
    }
  }

  void prefetch(std::int64_t element) const { __builtin_prefetch(coefficients_ + element * stride); }

  /// Sets the forces of `Count` elements, that follow each other along x, on their lower and upper faces.
  template <int Count>
  [[gnu::always_inline]] void apply(std::int64_t element, const Modes<Count>& lower,
                                    const Modes<Count>& upper, Modes<Count>& lower_forces,
                                    Modes<Count>& upper_forces) const {
    const auto coefficient = [&](int which) __attribute__((always_inline)) {
      if constexpr (Width == 1)
        return of_pairs<Count>(coefficients_ + element * stride, which);
      else
        return joined_pieces<Count>([&](int k) __attribute__((always_inline)) {
          return Lanes<Width, Real>::broadcast(coefficients_[(element + k) * stride + which]);
        });
    };
    const auto diffusivity = coefficient(0), reaction = coefficient(1);
    const auto entry = [&](int mode) __attribute__((always_inline)) {
      return diffusivity * conductivity_[mode] + reaction * mass_[mode];
    };
#pragma GCC unroll 4
    for (int mode = 0; mode < corner_count<Dim> / 2; ++mode) {
      const auto even = (lower[0][mode] + upper[0][mode]) * entry(2 * mode);
      const auto odd = (lower[0][mode] - upper[0][mode]) * entry(2 * mode + 1);
      lower_forces[0][mode] = even + odd;
      upper_forces[0][mode] = even - odd;
    }
  }

 private:
  std::array<Real, corner_count<Dim>> conductivity_, mass_;
  const Real* coefficients_;
};

}  // namespace fabseq
