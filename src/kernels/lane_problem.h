// SPDX-License-Identifier: MIT
/// \file
/// What the lane solver needs to know of a differential operator: elasticity with one layer per lane, or
/// conduction with one right-hand side per lane.
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "kernels/element_kernels.h"

#include <array>

namespace fabseq {

/// Linear elasticity (docs/formulation.md 4.1): every lane has stiffness factors of its own.
template <int Dim>
class LaneElasticityProblem {
 public:
  static constexpr int dim = Dim;
  static constexpr int components = Dim;
  static constexpr int element_size = element_unknowns<Dim>;
  /// Whether lanes differ in their operator, not only in their right-hand side.
  static constexpr bool own_operators = true;
  /// Operators of so many lanes.
  template <int Width>
  static constexpr int operators = Width;
  template <int Width, class Real = double>
  using Kernel = ElasticKernel<Dim, Width, Real>;

  /// Matrices of a level's elements.
  struct Matrices {
    SquareMatrix<element_size> stiffness{};
    ParityMatrix<Dim, Dim> parity;
    double spectrum_bound = 0.0;  ///< of the operator scaled by its node blocks, whatever the coefficients
  };

  LaneElasticityProblem(double thickness, double poisson) : thickness_(thickness), poisson_(poisson) {}

  Matrices matrices(const Point<Dim>& spacing) const {
    Matrices result;
    result.stiffness = ElementMatrices<Dim>(spacing, thickness_, poisson_).stiffness();
    result.parity = ParityMatrix<Dim, Dim>(result.stiffness);
    result.spectrum_bound = scaled_spectrum_bound(result.stiffness, corner_count<Dim>, Dim);
    return result;
  }
  template <int Width, class Real>
  static Kernel<Width, Real> kernel(const Matrices& matrices, const Real* coefficients) {
    return {matrices.parity, coefficients};
  }
  /// Entry of an element's matrix in a lane.
  template <int Width, class Real>
  static double entry(const Matrices& matrices, int row, int column, const Real* coefficients, int lane) {
    return matrices.stiffness[row * element_size + column] * coefficients[lane];
  }
  /// The same in all operators.
  template <int Width, class Real>
  static Lanes<operators<Width>> entries(const Matrices& matrices, int row, int column,
                                         const Real* coefficients) {
    return Lanes<operators<Width>>::load(coefficients) * matrices.stiffness[row * element_size + column];
  }

 private:
  double thickness_, poisson_;
};

/// Conduction with a reaction term (docs/formulation.md 2.1): one operator, one right-hand side per lane.
template <int Dim>
class LaneHeatProblem {
 public:
  static constexpr int dim = Dim;
  static constexpr int components = 1;
  static constexpr int element_size = corner_count<Dim>;
  static constexpr bool own_operators = false;
  template <int Width>
  static constexpr int operators = 1;
  template <int Width, class Real = double>
  using Kernel = HeatKernel<Dim, Width, Real>;

  struct Matrices {
    SquareMatrix<element_size> conductivity{}, mass{};
    ParityMatrix<Dim, 1> conductivity_parity, mass_parity;
    double spectrum_bound = 0.0;
  };

  LaneHeatProblem(double thickness, bool lumped) : thickness_(thickness), lumped_(lumped) {}

  Matrices matrices(const Point<Dim>& spacing) const {
    Matrices result;
    const ElementMatrices<Dim> element(spacing, thickness_, 0.0);
    result.conductivity = element.conductivity();
    result.mass = element.mass(lumped_);
    result.conductivity_parity = ParityMatrix<Dim, 1>(result.conductivity);
    result.mass_parity = ParityMatrix<Dim, 1>(result.mass);
    // Sums of element matrices scaled by sums of their diagonals: no more than the larger of the two.
    result.spectrum_bound = std::max(scaled_spectrum_bound(result.conductivity, element_size, 1),
                                     scaled_spectrum_bound(result.mass, element_size, 1));
    return result;
  }
  template <int Width, class Real>
  static Kernel<Width, Real> kernel(const Matrices& matrices, const Real* coefficients) {
    return {matrices.conductivity_parity, matrices.mass_parity, coefficients};
  }
  template <int Width, class Real>
  static double entry(const Matrices& matrices, int row, int column, const Real* coefficients, int) {
    const int at = row * element_size + column;
    return matrices.conductivity[at] * coefficients[0] + matrices.mass[at] * coefficients[1];
  }
  template <int Width, class Real>
  static Lanes<1> entries(const Matrices& matrices, int row, int column, const Real* coefficients) {
    return {entry<Width>(matrices, row, column, coefficients, 0)};
  }

 private:
  double thickness_;
  bool lumped_;
};

}  // namespace fabseq
