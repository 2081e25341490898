// SPDX-License-Identifier: MIT
/// \file
/// The finite elements once more, by the shortest way: tensor formulas, four Gauss points an axis, dense
/// matrices over the whole grid on every rank. Shares nothing with the library but the numbering of corners.
#pragma once

#include "fabseq/base/blas.h"
#include "fabseq/grid/index_box.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace fabseq::test {

/// Integrals over one element; unknown = corner * Dim + component. `Real` may be longer than double.
template <int Dim, class Real = double>
struct BruteForceElement {
  static constexpr int corners = corner_count<Dim>;
  static constexpr int unknowns = corners * Dim;

  Point<Dim> spacing;
  Real thickness, poisson;

  Real lame() const {  // unit Young's modulus; plane stress in 2D
    const Real solid = poisson / ((1 + poisson) * (1 - 2 * poisson));
    return Dim == 2 ? 2 * solid * shear() / (solid + 2 * shear()) : solid;
  }
  Real shear() const { return Real(0.5) / (1 + poisson); }

  /// Shape function of a corner, or its derivative along `axis`, at x in [0, 1]^Dim.
  Real shape(int corner, const std::array<Real, Dim>& x, int axis = -1) const {
    Real product = 1.0;
    for (int a = 0; a < Dim; ++a) {
      const bool upper = ((corner >> a) & 1) != 0;
      if (a == axis)
        product *= (upper ? 1.0 : -1.0) / spacing[a];
      else
        product *= upper ? x[a] : 1.0 - x[a];
    }
    return product;
  }

  template <class Function>
  Real integrate(Function&& f) const {
    const Real three = 3, six = 6, thirty = 30;
    const Real inner = std::sqrt(three / 7 - 2 * std::sqrt(six / 5) / 7);
    const Real outer = std::sqrt(three / 7 + 2 * std::sqrt(six / 5) / 7);
    const std::array<Real, 4> point = {-outer, -inner, inner, outer};
    const Real light = (18 - std::sqrt(thirty)) / 36, heavy = (18 + std::sqrt(thirty)) / 36;
    const std::array<Real, 4> weight = {light, heavy, heavy, light};
    Index<Dim> size;
    size.fill(4);
    Real total = 0.0;
    IndexBox<Dim>{{}, size}.for_each([&](const Index<Dim>& index, std::int64_t) {
      std::array<Real, Dim> x;
      Real w = thickness;
      for (int a = 0; a < Dim; ++a) {
        x[a] = 0.5 + 0.5 * point[index[a]];
        w *= 0.5 * weight[index[a]] * spacing[a];
      }
      total += w * f(x);
    });
    return total;
  }

  Real mass(int i, int j) const {
    return integrate([&](const auto& x) { return shape(i, x) * shape(j, x); });
  }
  Real conductivity(int i, int j) const {
    return integrate([&](const auto& x) {
      Real product = 0.0;
      for (int a = 0; a < Dim; ++a) product += shape(i, x, a) * shape(j, x, a);
      return product;
    });
  }
  /// lambda d_a N_i d_b N_j + mu (d_b N_i d_a N_j + delta_ab grad N_i . grad N_j).
  Real stiffness(int row, int column) const {
    const int i = row / Dim, a = row % Dim, j = column / Dim, b = column % Dim;
    return integrate([&](const auto& x) {
      Real value = lame() * shape(i, x, a) * shape(j, x, b) + shear() * shape(i, x, b) * shape(j, x, a);
      for (int c = 0; a == b && c < Dim; ++c) value += shear() * shape(i, x, c) * shape(j, x, c);
      return value;
    });
  }
  /// Stress of a strain, both as tensors.
  std::array<Point<Dim>, Dim> stress(const std::array<Point<Dim>, Dim>& strain) const {
    std::array<Point<Dim>, Dim> result{};
    double trace = 0.0;
    for (int a = 0; a < Dim; ++a) trace += strain[a][a];
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b)
        result[a][b] = 2 * shear() * strain[a][b] + (a == b ? lame() * trace : 0.0);
    return result;
  }
  /// sigma_ab d_b N_i.
  Real strain_load(int row, const std::array<Point<Dim>, Dim>& strain) const {
    const auto sigma = stress(strain);
    return integrate([&](const auto& x) {
      Real value = 0.0;
      for (int b = 0; b < Dim; ++b) value += sigma[row % Dim][b] * shape(row / Dim, x, b);
      return value;
    });
  }
  /// Symmetric displacement gradient at the centre.
  std::array<Point<Dim>, Dim> center_strain(const std::array<double, unknowns>& u) const {
    std::array<Real, Dim> center;
    center.fill(0.5);
    std::array<Point<Dim>, Dim> result{};
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b)
        for (int i = 0; i < corners; ++i)
          result[a][b] += 0.5 * (shape(i, center, b) * u[i * Dim + a] + shape(i, center, a) * u[i * Dim + b]);
    return result;
  }

  template <int Rows, class Entry>
  static std::array<Real, Rows * Rows> matrix(Entry&& entry) {
    std::array<Real, Rows * Rows> result{};
    for (int i = 0; i < Rows; ++i)
      for (int j = 0; j < Rows; ++j) result[i * Rows + j] = entry(i, j);
    return result;
  }
};

/// An inherent strain, Voigt, with every component different.
template <int Dim>
std::vector<double> some_strain() {
  if constexpr (Dim == 2)
    return {-0.01, 0.004, 0.007};
  else
    return {-0.01, 0.004, 0.003, 0.007, -0.002, 0.005};
}
/// Tensor of a Voigt strain (xx,yy,zz,xy,yz,zx or xx,yy,xy, engineering shear), and back for a stress.
template <int Dim>
std::array<Point<Dim>, Dim> strain_tensor(const std::vector<double>& voigt) {
  std::array<Point<Dim>, Dim> result{};
  for (int a = 0; a < Dim; ++a) result[a][a] = voigt[a];
  for (int s = 0; s < Dim * (Dim - 1) / 2; ++s) {
    const int a = s, b = (s + 1) % Dim;
    result[a][b] = result[b][a] = 0.5 * voigt[Dim + s];
  }
  return result;
}
template <int Dim>
std::vector<double> stress_voigt(const std::array<Point<Dim>, Dim>& tensor) {
  if constexpr (Dim == 2)
    return {tensor[0][0], tensor[1][1], tensor[0][1]};
  else
    return {tensor[0][0], tensor[1][1], tensor[2][2], tensor[0][1], tensor[1][2], tensor[2][0]};
}

/// Whether a symmetric matrix of `size` rows is positive definite.
inline bool is_positive_definite(std::vector<double> matrix, int size) {
  std::vector<double> unused(size, 0.0);
  const int one = 1;
  int info = 0;
  dposv_("L", &size, &one, matrix.data(), &size, unused.data(), &size, &info);
  return info == 0;
}

/// A dense system over all nodes of a grid, [node][component], nodes lexicographic. Unknowns that no element
/// touches come out 0.
template <int Dim>
class DenseSystem {
 public:
  DenseSystem(const Index<Dim>& elements, int components) : components_(components) {
    for (int a = 0; a < Dim; ++a) nodes_.size[a] = elements[a] + 1;
    size_ = static_cast<int>(nodes_.count()) * components;
    matrix_.assign(static_cast<std::size_t>(size_) * size_, 0.0);
    fixed_.assign(size_, 0);
  }

  const IndexBox<Dim>& nodes() const { return nodes_; }
  int size() const { return size_; }
  /// Unknown number `i` of an element.
  std::size_t unknown(const Index<Dim>& element, int i) const {
    Index<Dim> node = element;
    for (int a = 0; a < Dim; ++a) node[a] += (i / components_ >> a) & 1;
    return nodes_.offset(node) * components_ + i % components_;
  }
  template <class Matrix>
  void add(const Index<Dim>& element, const Matrix& matrix, double factor) {
    const int rows = components_ * corner_count<Dim>;
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < rows; ++j)
        matrix_[unknown(element, i) * size_ + unknown(element, j)] += factor * matrix[i * rows + j];
  }
  /// Prescribes the value 0.
  void fix(std::size_t unknown) { fixed_[unknown] = 1; }

  std::vector<double> multiply(const std::vector<double>& x) const {
    std::vector<double> result(size_, 0.0);
    for (int i = 0; i < size_; ++i)
      for (int j = 0; j < size_; ++j) result[i] += matrix_[static_cast<std::size_t>(i) * size_ + j] * x[j];
    return result;
  }
  std::vector<double> solve(std::vector<double> load) const {
    std::vector<double> factor = matrix_;
    for (int i = 0; i < size_; ++i) {
      const std::size_t diagonal = static_cast<std::size_t>(i) * size_ + i;
      if (fixed_[i] == 0 && matrix_[diagonal] > 0.0) continue;
      for (int j = 0; j < size_; ++j)
        factor[static_cast<std::size_t>(i) * size_ + j] = factor[static_cast<std::size_t>(j) * size_ + i] =
            0.0;
      factor[diagonal] = 1.0;
      load[i] = 0.0;
    }
    const int one = 1;
    int info = 0;
    dposv_("L", &size_, &one, factor.data(), &size_, load.data(), &size_, &info);
    EXPECT_EQ(info, 0) << "the dense matrix is not positive definite";
    return load;
  }

 private:
  IndexBox<Dim> nodes_;
  int components_, size_ = 0;
  std::vector<double> matrix_;
  std::vector<char> fixed_;
};

}  // namespace fabseq::test
