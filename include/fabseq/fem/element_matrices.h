// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"

#include <array>
#include <span>

namespace fabseq {

/// Entries of a strain or stress in Voigt order: xx,yy,zz,xy,yz,zx in 3D and xx,yy,xy in 2D, engineering
/// shear.
template <int Dim>
constexpr int voigt_size = Dim*(Dim + 1) / 2;

/// Displacement unknowns of an element; unknown = corner * Dim + component.
template <int Dim>
constexpr int element_unknowns = Dim* corner_count<Dim>;

/// A square matrix, row by row.
template <int Size>
using SquareMatrix = std::array<double, static_cast<std::size_t>(Size) * Size>;

/// The matrices of a box element, Q4 (plane stress) or H8, with edge lengths `spacing`, by full Gauss
/// integration (docs/formulation.md 1, 2.1, 4.1); in 2D integrals carry the thickness.
template <int Dim>
class ElementMatrices {
 public:
  static constexpr int corners = corner_count<Dim>;
  static constexpr int unknowns = element_unknowns<Dim>;
  using Gradient = std::array<double, unknowns>;  ///< [corner][axis]

  ElementMatrices(const Point<Dim>& spacing, double thickness, double poisson);

  /// K_0: integral of B^T C B for unit Young's modulus.
  const SquareMatrix<unknowns>& stiffness() const { return stiffness_; }
  /// Integral of grad N_i . grad N_j.
  const SquareMatrix<corners>& conductivity() const { return conductivity_; }
  /// Integral of N_i N_j; or `lumped`, its row sums on the diagonal.
  const SquareMatrix<corners>& mass(bool lumped) const { return lumped ? lumped_mass_ : consistent_mass_; }
  /// Derivatives of the shape functions at the element's centre, 1/length.
  const Gradient& center_gradient() const { return center_gradient_; }
  /// Integral of B^T C strain for unit Young's modulus: the load of an inherent strain (Voigt).
  std::array<double, unknowns> strain_load(std::span<const double> strain) const;
  /// C B(centre) u: stress at the element's centre for unit Young's modulus.
  std::array<double, voigt_size<Dim>> center_stress(std::span<const double, unknowns> displacement) const;
  /// C strain.
  std::array<double, voigt_size<Dim>> stress(std::span<const double> strain) const;

 private:
  using StrainMatrix = std::array<std::array<double, unknowns>, voigt_size<Dim>>;
  static StrainMatrix strain_matrix(const Gradient& gradient);
  /// C strain, column by column.
  StrainMatrix stress_matrix(const StrainMatrix& strain) const;

  SquareMatrix<voigt_size<Dim>> elasticity_;
  SquareMatrix<unknowns> stiffness_{};
  SquareMatrix<corners> conductivity_{}, consistent_mass_{}, lumped_mass_{};
  Gradient center_gradient_{};
  StrainMatrix center_stress_{};  ///< C B at the element's centre
  double volume_ = 0.0;
};

}  // namespace fabseq
