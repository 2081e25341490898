// SPDX-License-Identifier: MIT
/// \file
/// What lane kernels compute with, and the same element matrices by brute force. Coefficients differ by nine
/// decades between neighbours.
#pragma once

#include "kernels/lane_problem.h"
#include "support/brute_force.h"
#include "support/masked_box.h"

#include <vector>

namespace fabseq::test {

/// Unequal edges.
template <int Dim>
Point<Dim> lane_spacing() {
  Point<Dim> result{};
  for (int axis = 0; axis < Dim; ++axis) result[axis] = 0.5 - 0.1 * axis;
  return result;
}
template <int Dim>
constexpr double lane_thickness = Dim == 2 ? 0.25 : 1.0;

template <int Dim>
BruteForceElement<Dim> lane_element() {
  return {lane_spacing<Dim>(), lane_thickness<Dim>, 0.3};
}

/// Another stiffness in every element and lane.
template <int Dim_>
struct ElasticPhysics {
  static constexpr int Dim = Dim_;
  static constexpr int components = Dim;
  using Problem = LaneElasticityProblem<Dim>;

  /// Entry of an element's coefficients as the kernel takes them.
  static double coefficient(std::int64_t element, int lane) { return wild_factor(element, lane); }
  /// `coefficients(entry)`: here the stiffness, of a lane.
  template <class Coefficients>
  std::vector<double> matrix_with(Coefficients&& coefficients) const {
    std::vector<double> result(matrix.begin(), matrix.end());
    const double factor = coefficients(0);
    for (double& entry : result) entry *= factor;
    return result;
  }
  std::vector<double> element_matrix(std::int64_t element, int lane) const {
    return matrix_with([&](int) { return coefficient(element, lane); });
  }

  Problem problem{lane_thickness<Dim>, lane_element<Dim>().poisson};
  typename Problem::Matrices matrices = problem.matrices(lane_spacing<Dim>());
  SquareMatrix<element_unknowns<Dim>> matrix = lane_element<Dim>().template matrix<element_unknowns<Dim>>(
      [](int i, int j) { return lane_element<Dim>().stiffness(i, j); });
};

/// One operator for all lanes.
template <int Dim_>
struct HeatPhysics {
  static constexpr int Dim = Dim_;
  static constexpr int components = 1;
  static constexpr int corners = corner_count<Dim>;
  using Problem = LaneHeatProblem<Dim>;

  /// Diffusivity and reaction.
  static double coefficient(std::int64_t element, int entry) {
    return entry == 0 ? wild_factor(element, 0) : 10.0 * noise(element, 3);
  }
  template <class Coefficients>
  std::vector<double> matrix_with(Coefficients&& coefficients) const {
    std::vector<double> result(conductivity.size());
    const double diffusivity = coefficients(0), reaction = coefficients(1);
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = diffusivity * conductivity[i] + reaction * mass[i];
    return result;
  }
  std::vector<double> element_matrix(std::int64_t element, int) const {
    return matrix_with([&](int entry) { return coefficient(element, entry); });
  }

  Problem problem{lane_thickness<Dim>, false};
  typename Problem::Matrices matrices = problem.matrices(lane_spacing<Dim>());
  SquareMatrix<corners> conductivity = lane_element<Dim>().template matrix<corners>(
      [](int i, int j) { return lane_element<Dim>().conductivity(i, j); });
  SquareMatrix<corners> mass = lane_element<Dim>().template matrix<corners>(
      [](int i, int j) { return lane_element<Dim>().mass(i, j); });
};

using AllPhysics = testing::Types<ElasticPhysics<2>, ElasticPhysics<3>, HeatPhysics<2>, HeatPhysics<3>>;

}  // namespace fabseq::test
