// SPDX-License-Identifier: MIT
/// \file
/// What plastic flow with one state per element (formulation 16) takes from an H8 element, from shape
/// functions and 2 x 2 x 2 Gauss points. Shares nothing with the library but the numbering of corners.
#pragma once

#include "support/brute_force.h"

#include <array>
#include <cmath>

namespace fabseq::test {

using SixNumbers = std::array<double, 6>;  ///< Voigt: xx,yy,zz,xy,yz,zx, engineering shear

inline double paired(const SixNumbers& a, const SixNumbers& b) {
  double result = 0.0;
  for (int i = 0; i < 6; ++i) result += a[i] * b[i];
  return result;
}

/// sqrt(3/2 d:d) of a stress deviator.
inline double equivalent_stress(const SixNumbers& deviator) {
  double square = 0.0;
  for (int i = 0; i < 6; ++i) square += (i < 3 ? 1.5 : 3.0) * deviator[i] * deviator[i];
  return std::sqrt(square);
}

inline SixNumbers deviator(SixNumbers stress) {
  const double mean = (stress[0] + stress[1] + stress[2]) / 3.0;
  for (int i = 0; i < 3; ++i) stress[i] -= mean;
  return stress;
}

/// Mean strains, volume and hourglass stiffness. Unknown = corner * 3 + component; unit Young's modulus.
struct FlowElement {
  static constexpr int unknowns = 24;
  using Vector = std::array<double, unknowns>;

  FlowElement(const Point<3>& spacing_, double poisson)
      : spacing(spacing_),
        lame(poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))),
        shear(0.5 / (1.0 + poisson)) {
    const BruteForceElement<3> shapes{spacing, 1.0, poisson};
    volume = spacing[0] * spacing[1] * spacing[2];
    const double offset = 0.5 / std::sqrt(3.0);
    for (int point = 0; point < 8; ++point) {
      Point<3> x;
      for (int a = 0; a < 3; ++a) x[a] = 0.5 + ((point >> a & 1) != 0 ? offset : -offset);
      std::array<SixNumbers, unknowns> columns{};
      for (int i = 0; i < unknowns; ++i) {
        const int corner = i / 3, a = i % 3;
        columns[i][a] = shapes.shape(corner, x, a);
        // The shears xy, yz, zx that this component takes part in, with the derivatives along the other axis.
        columns[i][3 + a] = shapes.shape(corner, x, (a + 1) % 3);
        columns[i][3 + (a + 2) % 3] = shapes.shape(corner, x, (a + 2) % 3);
        for (int c = 0; c < 6; ++c) mean_strain[i][c] += columns[i][c] / 8.0;
      }
      add_stiffness(columns, volume / 8.0);
    }
    add_stiffness(mean_strain, -volume);
  }

  /// C, symmetric.
  SixNumbers stress(const SixNumbers& strain) const {
    SixNumbers result;
    for (int i = 0; i < 6; ++i)
      result[i] =
          i < 3 ? lame * (strain[0] + strain[1] + strain[2]) + 2.0 * shear * strain[i] : shear * strain[i];
    return result;
  }
  /// Inverse of stress().
  SixNumbers strain(const SixNumbers& stress) const {
    const double share = lame / (3.0 * lame + 2.0 * shear);
    SixNumbers result;
    for (int i = 0; i < 6; ++i)
      result[i] = i < 3 ? (stress[i] - share * (stress[0] + stress[1] + stress[2])) / (2.0 * shear)
                        : stress[i] / shear;
    return result;
  }
  SixNumbers mean(const Vector& displacement) const {
    SixNumbers result{};
    for (int i = 0; i < unknowns; ++i)
      for (int c = 0; c < 6; ++c) result[c] += mean_strain[i][c] * displacement[i];
    return result;
  }
  /// K_h u.
  Vector hourglass_force(const Vector& displacement) const {
    Vector result{};
    for (int i = 0; i < unknowns; ++i)
      for (int j = 0; j < unknowns; ++j) result[i] += hourglass[i * unknowns + j] * displacement[j];
    return result;
  }

  Point<3> spacing;
  double lame, shear, volume;
  std::array<SixNumbers, unknowns> mean_strain{};       ///< columns of the mean of B
  std::array<double, unknowns * unknowns> hourglass{};  ///< K_h

 private:
  void add_stiffness(const std::array<SixNumbers, unknowns>& columns, double weight) {
    for (int j = 0; j < unknowns; ++j) {
      const SixNumbers of_column = stress(columns[j]);
      for (int i = 0; i < unknowns; ++i)
        hourglass[i * unknowns + j] += weight * paired(columns[i], of_column);
    }
  }
};

}  // namespace fabseq::test
