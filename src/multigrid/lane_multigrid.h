// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/multigrid/lane_cycle.h"
#include "kernels/lane_array.h"
#include "multigrid/lane_direct.h"
#include "multigrid/lane_operator.h"

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// A preconditioner for K x = b in every lane, geometric multigrid: Chebyshev smoothing with node blocks,
/// coarse operators by re-discretization with the mean of the children's coefficients, band Cholesky on the
/// last level. Vectors as LaneOperator's, on the finest level. Collective on the grid's communicator.
///
/// `Real`: of vectors and coefficients; the solves on the last level are in double precision all the same. A
/// preconditioner in single precision moves half the bytes. Its rounding, about 1e-7 of the forces, is little
/// in energy but may move what hangs by little: see LaneCg.
template <class Problem, int Width, class Real = double>
class LaneMultigrid {
 public:
  static constexpr int dim = Problem::dim;
  static constexpr int components = Problem::components;
  static constexpr int node_values = components * Width;
  using Operator = LaneOperator<Problem, Width, Real>;
  using Scalars = LaneScalars<Width>;

  /// `hierarchy` must outlive the multigrid.
  LaneMultigrid(LaneHierarchy<dim>& hierarchy, const Problem& problem, const LaneCycle& cycle);

  Operator& finest() { return *levels_.front().matrix; }
  /// Sets up all levels once the finest level's coefficients have been filled in. False in lanes whose last
  /// level is not positive definite: their operators are not, either.
  std::array<bool, Width> set_up();
  /// Takes over lanes of a wider multigrid on the same hierarchy, without setting up.
  template <int Wider>
  void select(LaneMultigrid<Problem, Wider, Real>& from, std::span<const int> lanes);

  /// Sets whether coarse levels take more steps from now on; only for flexible methods.
  void be_patient(bool patient) { patient_ = patient; }
  /// x = M b.
  void apply(const Real* b, Real* x) { visit(0, b, x); }

 private:
  template <class, int, class>
  friend class LaneMultigrid;
  using Array = LaneValues<Real>;

  struct Level {
    std::unique_ptr<Operator> matrix;
    Array residual, step;               ///< of the smoother
    Array right, solution;              ///< below the finest
    Array stage_right, stage_solution;  ///< the same on the finer level's stage, if it has one
    Array cg_residual, direction, image, scratch, product;  ///< of conjugate gradients
  };
  /// Where a level's right-hand side is restricted to, and its solution interpolated from.
  Array& right_of_parts(int index) {
    return hierarchy_.level(index - 1).staged ? levels_[index].stage_right : levels_[index].right;
  }
  Array& solution_of_parts(int index) {
    return hierarchy_.level(index - 1).staged ? levels_[index].stage_solution : levels_[index].solution;
  }
  void coarsen_coefficients(int level);
  /// One cycle from zero on a level: x = M b.
  void visit(int index, const Real* b, Real* x);
  void restrict_residual(int index);
  void prolong(int index, Real* x);
  /// Solves on a level below the finest, from its `right` to its `solution`.
  void solve(int index);
  int steps_on(int index, bool patient) const { return cycle_.steps_on(index, hierarchy_.count(), patient); }
  void iterate(int index, int steps);
  void conjugate_gradients(int index, int steps);
  /// The vector updates of a step.
  template <bool First>
  void advance(Level& level, const Scalars& alpha, const Scalars& beta, bool last);

  LaneHierarchy<dim>& hierarchy_;
  LaneCycle cycle_;
  bool patient_ = false;
  std::vector<Level> levels_;
  LaneDirect<Problem, Width, Real> direct_;
};

}  // namespace fabseq
