// SPDX-License-Identifier: MIT
/// \file
/// Conjugate gradients in lanes, with loads of known solutions: sums over the elements one by one.
#pragma once

#include "cg/lane_cg.h"
#include "support/lane_physics.h"
#include "support/masked_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace fabseq::test {

template <int Dim>
Index<Dim> odd_size() {
  if constexpr (Dim == 2)
    return {51, 49};
  else
    return {11, 9, 8};
}

/// A coefficient of an element and lane (or entry, for heat).
using Coefficient = std::function<double(std::int64_t, int)>;

/// Three decades.
template <class Physics>
double moderate(std::int64_t element, int entry) {
  return std::pow(Physics::coefficient(element, entry), 1.0 / 3.0);
}

/// A solver and loads of known solutions.
template <class Physics, int Width>
struct LaneCgCase {
  static constexpr int Dim = Physics::Dim;
  static constexpr int components = Physics::components;
  using Problem = typename Physics::Problem;
  static constexpr int stride = Problem::template Kernel<Width>::stride;

  explicit LaneCgCase(const LaneCycle& cycle = {}, const Coefficient& coefficient_ = moderate<Physics>,
                      MPI_Comm comm_ = PETSC_COMM_WORLD, const Mask<Dim>& mask = masks<Dim>()[0],
                      const Index<Dim>& size = odd_size<Dim>())
      : comm(comm_),
        coefficient(coefficient_),
        masked(comm, size, mask, components, MaskedGrid<Dim>::on_plate(size, {Dim - 1, false})),
        touching(masked.whole.touching_elements()),
        hierarchy(masked.grid, masked.domain),
        cg(hierarchy, physics.problem, cycle) {
    cg.matrix().coefficients() =
        coefficient_array(hierarchy.level(0).mesh, masked.grid.all_elements(), stride, coefficient);
    cg.set_up();
  }

  /// Solution on all nodes of the grid.
  std::vector<double> expected(int lane) const {
    std::vector<double> result;
    for (std::int64_t i = 0; i < masked.whole.nodes.count() * components; ++i) {
      const auto node = masked.whole.nodes.index(i / components);
      const bool is_free = touching[i / components] > 0 && node[Dim - 1] != 0;
      result.push_back(is_free ? noise(i, lane) - 0.5 : 0.0);
    }
    return result;
  }
  std::vector<double> load(int lane) const {
    return multiply(
               masked.whole, components,
               [&](std::int64_t element) {
                 return physics.matrix_with(
                     [&](int entry) { return coefficient(element, Problem::own_operators ? lane : entry); });
               },
               expected(lane))
        .value;
  }
  /// The loads of `lanes` lanes, times `factor(lane)`.
  LaneArray loads(
      int lanes, const std::function<double(int)>& factor = [](int) { return 1.0; }) const {
    std::vector<std::vector<double>> all;
    for (int lane = 0; lane < lanes; ++lane) all.push_back(load(lane));
    return lane_array(hierarchy.level(0).mesh, masked.whole.nodes, components, Width,
                      [&](std::int64_t unknown, int lane) {
                        return lane < lanes ? factor(lane) * all[lane][unknown] : 0.0;
                      });
  }
  std::vector<LaneOutcome> solve(LaneArray load, int lanes, const LaneStop& stop = {.tolerance = 1e-9}) {
    return cg.solve(load, solution, lanes, stop);
  }
  std::vector<double> whole(int lane) const {
    return whole_lane(comm, hierarchy.level(0).mesh, masked.whole.nodes, solution, components, Width, lane);
  }
  void expect_solved(const LaneOutcome& outcome, int lane, double factor = 1.0) const {
    EXPECT_TRUE(outcome.converged) << lane;
    EXPECT_TRUE(outcome.finite) << lane;
    EXPECT_LE(outcome.residual, 1e-9) << lane;
    auto wanted = expected(lane);
    for (double& value : wanted) value *= factor;
    EXPECT_LT(relative_difference(whole(lane), wanted), 1e-6) << lane;
  }

  MPI_Comm comm;
  Coefficient coefficient;
  MaskedGrid<Dim> masked;
  std::vector<int> touching;
  LaneHierarchy<Dim> hierarchy;
  Physics physics;
  LaneCg<Problem, Width> cg;
  LaneArray solution;
};

}  // namespace fabseq::test

namespace fabseq {

template <class T>
class LaneCgTest : public testing::Test {};
TYPED_TEST_SUITE(LaneCgTest, test::AllPhysics);

}  // namespace fabseq
