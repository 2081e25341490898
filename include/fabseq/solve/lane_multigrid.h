/// \file
/// Geometric multigrid for several lanes at once.
#pragma once

#include "fabseq/io/config.h"
#include "fabseq/solve/band_cholesky.h"
#include "fabseq/solve/island_modes.h"
#include "fabseq/solve/lane_operator.h"

#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// What the multigrid does in a cycle. Levels below the finest are visited once (V), several times as a fixed
/// iteration (W: fewer reductions, for many ranks), or in several steps of conjugate gradients (K: strongest;
/// needs a flexible method outside).
struct LaneCycle {
  SolverCycle kind = SolverCycle::k;
  int degree = 2;       ///< of the Chebyshev smoother, before and after
  bool islands = true;  ///< rigid motions of stiff islands, where lanes have operators of their own
  std::vector<int> steps{2, 4, 2};  ///< steps on levels 1, 2, ... (K) or visits (W); the last entry goes on
  std::vector<int> patient_steps{6, 4, 2};  ///< the same for lanes that take long (K only)
  int patience = 10;                        ///< iterations before a lane counts as one that takes long

  int steps_on(int level, bool patient) const {
    if (kind == SolverCycle::v) return 1;
    const std::vector<int>& list = patient && kind == SolverCycle::k ? patient_steps : steps;
    return list[std::min<std::size_t>(level - 1, list.size() - 1)];
  }
};

/// A preconditioner for K x = b in every lane: Chebyshev smoothing with node blocks, coarse operators by
/// re-discretization with the mean of the children's coefficients, band Cholesky on the last level. Vectors
/// as LaneOperator's, on the finest level. Collective on the grid's communicator.
template <class Problem, int Width>
class LaneMultigrid {
 public:
  static constexpr int dim = Problem::dim;
  static constexpr int components = Problem::components;
  static constexpr int block = components * Width;
  using Operator = LaneOperator<Problem, Width>;
  using Scalars = LaneScalars<Width>;

  /// `hierarchy` must outlive the multigrid.
  LaneMultigrid(LaneHierarchy<dim>& hierarchy, const Problem& problem, const LaneCycle& cycle);

  Operator& finest() { return *levels_.front().matrix; }
  /// To be called when the finest level's coefficients have been filled in. False in lanes whose last level
  /// is not positive definite (then their operators are not).
  std::array<bool, Width> set_up();
  /// Takes over lanes of a wider multigrid on the same hierarchy, without setting up.
  template <int Wider>
  void select(LaneMultigrid<Problem, Wider>& from, std::span<const int> lanes);

  /// From now on with more steps on the coarse levels, or not; only for flexible methods.
  void be_patient(bool patient) { patient_ = patient; }
  /// x = M b.
  void apply(const double* b, double* x) { visit(0, b, x); }

 private:
  template <class, int>
  friend class LaneMultigrid;

  struct Level {
    std::unique_ptr<Operator> matrix;
    LaneArray residual, step;                            ///< of the smoother
    LaneArray right, solution;                           ///< below the finest
    LaneArray rest, direction, image, scratch, product;  ///< of conjugate gradients
  };
  void coarsen_coefficients(int level);
  void find_islands();
  void factor(std::array<bool, Width>& positive);
  /// One cycle from zero on a level: x = M b.
  void visit(int index, const double* b, double* x);
  void restrict_residual(int index);
  /// Solves on a level below the finest, from its `right` to its `solution`.
  void solve(int index);
  void iterate(int index, int steps);
  void conjugate_gradients(int index, int steps);
  void solve_directly();
  void sum(int index, std::span<double> scalars) const;

  LaneHierarchy<dim>& hierarchy_;
  LaneCycle cycle_;
  bool patient_ = false;
  std::vector<Level> levels_;
  BandNumbering<dim> numbering_;
  std::unique_ptr<IslandMap<dim>> island_map_;
  IslandModes<Problem, Width> islands_;
  static constexpr int factors = Problem::template operators<Width>;
  std::array<std::shared_ptr<BandCholesky>, factors> factors_;
  std::vector<double> direct_values_;
};

/// y += factor x in every lane.
template <int Width>
void add_scaled(const LaneScalars<Width>& factor, const LaneArray& x, LaneArray& y) {
  const auto scale = Lanes<Width>::load(factor.data());
  for (std::size_t i = 0; i < y.size(); i += Width)
    (Lanes<Width>::load(&y[i]) + scale * Lanes<Width>::load(&x[i])).store(&y[i]);
}

/// y = x + factor y in every lane.
template <int Width>
void scale_and_add(const LaneScalars<Width>& factor, const LaneArray& x, LaneArray& y) {
  const auto scale = Lanes<Width>::load(factor.data());
  for (std::size_t i = 0; i < y.size(); i += Width)
    (Lanes<Width>::load(&x[i]) + scale * Lanes<Width>::load(&y[i])).store(&y[i]);
}

}  // namespace fabseq
