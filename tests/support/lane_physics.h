/// \file
/// What lane kernels compute with, and the same element matrices by brute force. Coefficients differ by nine
/// decades between neighbours.
#pragma once

#include "fabseq/solve/lane_problem.h"

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
  std::vector<double> element_matrix(std::int64_t element, int lane) const {
    std::vector<double> result(matrix.begin(), matrix.end());
    for (double& entry : result) entry *= coefficient(element, lane);
    return result;
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
  std::vector<double> element_matrix(std::int64_t element, int) const {
    std::vector<double> result(conductivity.size());
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = coefficient(element, 0) * conductivity[i] + coefficient(element, 1) * mass[i];
    return result;
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
