// SPDX-License-Identifier: MIT
#include "fabseq/fem/element_matrices.h"

#include <cmath>

namespace fabseq {

namespace {

/// Shape functions and their physical derivatives at a point of the reference element [-1, 1]^Dim.
template <int Dim>
struct ShapeFunctions {
  std::array<double, corner_count<Dim>> value{};
  typename ElementMatrices<Dim>::Gradient gradient{};

  ShapeFunctions(const Point<Dim>& point, const Point<Dim>& spacing) {
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      std::array<double, Dim> factor{};
      std::array<double, Dim> slope{};
      for (int axis = 0; axis < Dim; ++axis) {
        const double sign = ((corner >> axis) & 1) != 0 ? 1.0 : -1.0;
        factor[axis] = 0.5 * (1.0 + sign * point[axis]);
        slope[axis] = sign / spacing[axis];
      }
      value[corner] = 1.0;
      for (int axis = 0; axis < Dim; ++axis) {
        value[corner] *= factor[axis];
        double derivative = slope[axis];
        for (int other = 0; other < Dim; ++other)
          if (other != axis) derivative *= factor[other];
        gradient[corner * Dim + axis] = derivative;
      }
    }
  }
};

template <int Dim>
Point<Dim> gauss_point(int index) {
  Point<Dim> point{};
  for (int axis = 0; axis < Dim; ++axis)
    point[axis] = (((index >> axis) & 1) != 0 ? 1.0 : -1.0) / std::sqrt(3.0);
  return point;
}

/// Isotropic elasticity for unit Young's modulus, Voigt; plane stress in 2D.
template <int Dim>
SquareMatrix<voigt_size<Dim>> elasticity_matrix(double poisson) {
  constexpr int size = voigt_size<Dim>;
  SquareMatrix<size> matrix{};
  const double shear = 0.5 / (1.0 + poisson);
  const double lame =
      Dim == 2 ? poisson / (1.0 - poisson * poisson) : poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
  for (int i = 0; i < Dim; ++i) {
    for (int j = 0; j < Dim; ++j) matrix[i * size + j] = lame;
    matrix[i * size + i] += 2.0 * shear;
  }
  for (int i = Dim; i < size; ++i) matrix[i * size + i] = shear;
  return matrix;
}

}  // namespace

template <int Dim>
typename ElementMatrices<Dim>::StrainMatrix ElementMatrices<Dim>::strain_matrix(const Gradient& gradient) {
  StrainMatrix matrix{};
  for (int corner = 0; corner < corners; ++corner) {
    for (int axis = 0; axis < Dim; ++axis) matrix[axis][corner * Dim + axis] = gradient[corner * Dim + axis];
    // Engineering shear xy, yz, zx: row Dim + a couples axes a and a + 1.
    for (int row = Dim; row < voigt_size<Dim>; ++row) {
      const int a = row - Dim;
      const int b = (a + 1) % Dim;
      matrix[row][corner * Dim + a] = gradient[corner * Dim + b];
      matrix[row][corner * Dim + b] = gradient[corner * Dim + a];
    }
  }
  return matrix;
}

template <int Dim>
typename ElementMatrices<Dim>::StrainMatrix ElementMatrices<Dim>::stress_matrix(
    const StrainMatrix& strain) const {
  StrainMatrix stress{};
  for (int r = 0; r < voigt_size<Dim>; ++r)
    for (int s = 0; s < voigt_size<Dim>; ++s)
      for (int j = 0; j < unknowns; ++j) stress[r][j] += elasticity_[r * voigt_size<Dim> + s] * strain[s][j];
  return stress;
}

template <int Dim>
ElementMatrices<Dim>::ElementMatrices(const Point<Dim>& spacing, double thickness, double poisson)
    : elasticity_(elasticity_matrix<Dim>(poisson)), volume_(thickness) {
  for (const double edge : spacing) volume_ *= edge;
  const double weight = volume_ / corners;
  for (int gauss = 0; gauss < corners; ++gauss) {
    const ShapeFunctions<Dim> shape(gauss_point<Dim>(gauss), spacing);
    for (int i = 0; i < corners; ++i)
      for (int j = 0; j < corners; ++j) {
        consistent_mass_[i * corners + j] += weight * shape.value[i] * shape.value[j];
        lumped_mass_[i * corners + i] += weight * shape.value[i] * shape.value[j];
        for (int axis = 0; axis < Dim; ++axis)
          conductivity_[i * corners + j] +=
              weight * shape.gradient[i * Dim + axis] * shape.gradient[j * Dim + axis];
      }
    const StrainMatrix strain = strain_matrix(shape.gradient);
    const StrainMatrix stress = stress_matrix(strain);
    for (int i = 0; i < unknowns; ++i)
      for (int j = 0; j < unknowns; ++j)
        for (int r = 0; r < voigt_size<Dim>; ++r)
          stiffness_[i * unknowns + j] += weight * strain[r][i] * stress[r][j];
  }
  center_gradient_ = ShapeFunctions<Dim>(Point<Dim>{}, spacing).gradient;
  center_stress_ = stress_matrix(strain_matrix(center_gradient_));
}

template <int Dim>
std::array<double, voigt_size<Dim>> ElementMatrices<Dim>::stress(std::span<const double> strain) const {
  std::array<double, voigt_size<Dim>> result{};
  for (int r = 0; r < voigt_size<Dim>; ++r)
    for (int s = 0; s < voigt_size<Dim>; ++s) result[r] += elasticity_[r * voigt_size<Dim> + s] * strain[s];
  return result;
}

template <int Dim>
std::array<double, ElementMatrices<Dim>::unknowns> ElementMatrices<Dim>::strain_load(
    std::span<const double> strain) const {
  // The mean of B over a box element is B at its centre.
  const auto constant_stress = stress(strain);
  const StrainMatrix mean = strain_matrix(center_gradient_);
  std::array<double, unknowns> load{};
  for (int i = 0; i < unknowns; ++i)
    for (int r = 0; r < voigt_size<Dim>; ++r) load[i] += volume_ * mean[r][i] * constant_stress[r];
  return load;
}

template <int Dim>
std::array<double, voigt_size<Dim>> ElementMatrices<Dim>::center_stress(
    std::span<const double, unknowns> displacement) const {
  std::array<double, voigt_size<Dim>> result{};
  for (int r = 0; r < voigt_size<Dim>; ++r)
    for (int i = 0; i < unknowns; ++i) result[r] += center_stress_[r][i] * displacement[i];
  return result;
}

FABSEQ_INSTANTIATE_CLASS(ElementMatrices);

}  // namespace fabseq
