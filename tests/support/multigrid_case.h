// SPDX-License-Identifier: MIT
/// \file
/// Lane multigrids on masked grids.
#pragma once

#include "kernels/lane_array.h"
#include "multigrid/lane_multigrid.h"
#include "multigrid/lane_multigrid_impl.h"
#include "support/lane_physics.h"
#include "support/masked_grid.h"

#include <array>
#include <vector>

namespace fabseq::test {

/// Everything is supported with these.
template <int Dim>
std::vector<Mask<Dim>> connected_masks() {
  return {masks<Dim>()[0], masks<Dim>()[3]};
}

/// A multigrid on a grid whose last axis has the plate, and vectors of random values.
template <class Physics, int Width>
struct MultigridCase {
  static constexpr int Dim = Physics::Dim;
  static constexpr int components = Physics::components;
  using Kernel = typename Physics::Problem::template Kernel<Width>;

  /// `coefficient` of an element of the grid and an entry.
  template <class Coefficient>
  MultigridCase(MPI_Comm comm_, const Index<Dim>& size, const Mask<Dim>& mask, const LaneCycle& cycle,
                Coefficient&& coefficient)
      : comm(comm_),
        masked(comm, size, mask, components, MaskedGrid<Dim>::on_plate(size, {Dim - 1, false})),
        touching(masked.whole.touching_elements()),
        hierarchy(masked.grid, masked.domain),
        multigrid(hierarchy, physics.problem, cycle) {
    multigrid.finest().coefficients() =
        coefficient_array(hierarchy.level(0).mesh, masked.grid.all_elements(), Kernel::stride, coefficient);
    positive = multigrid.set_up();
  }
  MultigridCase(MPI_Comm comm_, const Index<Dim>& size, const Mask<Dim>& mask, const LaneCycle& cycle)
      : MultigridCase(comm_, size, mask, cycle, [](std::int64_t element, int entry) {
          return std::pow(Physics::coefficient(element, entry), 1.0 / 3.0);  // three decades
        }) {}

  bool is_free(std::int64_t unknown) const {
    const auto node = masked.whole.nodes.index(unknown / components);
    return touching[unknown / components] > 0 && node[Dim - 1] != 0;
  }
  template <class Function>
  LaneArray vector(Function&& f) const {
    return lane_array(
        hierarchy.level(0).mesh, masked.whole.nodes, components, Width,
        [&](std::int64_t unknown, int lane) { return is_free(unknown) ? f(unknown, lane) : 0.0; });
  }
  LaneArray random(int salt) const {
    return vector([&](std::int64_t unknown, int lane) { return noise(unknown, salt + lane) - 0.5; });
  }
  LaneArray apply(const LaneArray& b) {
    LaneArray x(b.size(), NAN);
    multigrid.apply(b.data(), x.data());
    return x;
  }
  LaneScalars<Width> dot(const LaneArray& x, const LaneArray& y) {
    auto result = multigrid.finest().dot(x.data(), y.data());
    sum_in_place(comm, result);
    return result;
  }
  std::vector<double> whole(const LaneArray& values, int lane) const {
    return whole_lane(comm, hierarchy.level(0).mesh, masked.whole.nodes, values, components, Width, lane);
  }

  /// a . M b = b . M a, relative to a . M a and b . M b.
  void expect_symmetric_and_positive(double tolerance) {
    const LaneArray a = random(1), b = random(11);
    const LaneArray ma = apply(a), mb = apply(b);
    const auto aa = dot(a, ma), bb = dot(b, mb), ab = dot(a, mb), ba = dot(b, ma);
    for (int lane = 0; lane < Width; ++lane) {
      EXPECT_GT(aa[lane], 0.0);
      EXPECT_GT(bb[lane], 0.0);
      EXPECT_NEAR(ab[lane], ba[lane], tolerance * std::sqrt(aa[lane] * bb[lane]));
    }
  }

  MPI_Comm comm;
  MaskedGrid<Dim> masked;
  std::vector<int> touching;
  LaneHierarchy<Dim> hierarchy;
  Physics physics;
  LaneMultigrid<typename Physics::Problem, Width> multigrid;
  std::array<bool, Width> positive{};
};

inline LaneCycle cycle_of(SolverCycle kind, int degree = 2) {
  LaneCycle cycle;
  cycle.kind = kind;
  cycle.degree = degree;
  return cycle;
}

}  // namespace fabseq::test
