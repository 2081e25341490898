// SPDX-License-Identifier: MIT
#pragma once

#include "cg/free_motions.h"
#include "cg/lane_progress.h"
#include "islands/island_modes.h"
#include "kernels/lane_array.h"
#include "multigrid/lane_multigrid.h"

#include <memory>
#include <vector>

namespace fabseq {

/// Flexible conjugate gradients in double precision with lane multigrid in single precision, every lane with
/// scalars and a convergence test of its own. Rigid motions of stiff islands are solved for before the first
/// step and after each cycle of the multigrid, in double precision: the preconditioner is M + Q (1 - K M)
/// with Q = Z (Z^T K Z)^-1 Z^T. When half of the lanes or fewer are left, they go on in a solver half as
/// wide (LaneCycle::narrows). Collective on the grid's communicator.
template <class Problem, int Width>
class LaneCg {
 public:
  using Operator = LaneOperator<Problem, Width>;
  using Multigrid = LaneMultigrid<Problem, Width, float>;
  using Scalars = LaneScalars<Width>;
  using Half = LaneCg<Problem, std::max(1, Width / 2)>;

  /// `hierarchy` and `problem` must outlive the solver.
  LaneCg(LaneHierarchy<Problem::dim>& hierarchy, const Problem& problem, const LaneCycle& cycle);

  /// The solver for half as many lanes, made at first use.
  Half& half();
  /// K, whose coefficients are to be filled in. Takes the solver's memory, if it has none.
  Operator& matrix() {
    allocate();
    return *matrix_;
  }
  /// Gives all memory back, that of the narrower solvers, too; coefficients and set-up are lost.
  void release_memory();
  /// What is known of the islands: kept, it saves looking for them in the very same systems again.
  using Islands = typename IslandModes<Problem, Width>::Known;
  /// Sets up the multigrid for the coefficients given to matrix(). `islands`: of these systems, or nothing;
  /// they are looked for then, and set. Problems with one operator leave it as it is.
  void set_up(Islands& islands);
  void set_up() {
    Islands unknown;
    set_up(unknown);
  }
  /// Puts a diagonal on top of K, one entry per node of the mesh; empty: none. Problems with one operator
  /// only. The multigrid does not know of it: set_up_with() gives it coefficients that stand for it.
  void set_diagonal(LaneArray diagonal) { diagonal_ = std::move(diagonal); }
  /// set_up() with other coefficients of the multigrid than those of K.
  void set_up_with(const LaneArray& coefficients) {
    multigrid_->finest().coefficients().assign(coefficients.begin(), coefficients.end());
    positive_ = multigrid_->set_up();
  }
  /// Lets later solves iterate in the space without rigid motions, for a body that nothing holds, Width 1.
  /// Loads must balance themselves. `motions` must outlive the solver.
  void keep_free_of(const FreeMotions<Problem::dim>& motions) { free_motions_ = &motions; }
  /// Replaces filling in and setting up: takes over the first `count` lanes of half(), and behind them the
  /// same again, for further right-hand sides of these systems.
  void set_up_from_half(int count);
  /// Solves K u = f in the first `lanes` lanes; the others of `load` are ignored. Vectors as LaneOperator's,
  /// `load` is overwritten. With LaneStop::one_cycle, and without islands, u = M f. Throws Stopped, on all
  /// ranks in the same iteration, if one was asked to stop.
  std::vector<LaneOutcome> solve(LaneArray& load, LaneArray& solution, int lanes, const LaneStop& stop);
  /// The same from a multiple of a first guess, which `solution` holds; 0 in a lane: none. `smallest`: what
  /// is known of the smallest eigenvalues of M K, at most 1: a few steps tell little of them.
  std::vector<LaneOutcome> improve(LaneArray& load, LaneArray& solution, int lanes, const LaneStop& stop,
                                   const Scalars& smallest = LaneProgress<Width>::ones());

 private:
  template <class, int>
  friend class LaneCg;

  using Progress = LaneProgress<Width>;
  void allocate();
  template <int Other>
  void copy_set_up(LaneCg<Problem, Other>& other, std::span<const int> lanes);
  static void multiply(LaneArray& vector, const Scalars& factors);
  std::vector<LaneOutcome> solve_from(Progress& progress, LaneArray& load, LaneArray& solution, int lanes,
                                      const LaneStop& stop);
  std::vector<LaneOutcome> cycle_once(LaneArray& load, LaneArray& solution, int lanes);
  Scalars scales_of(LaneArray& load) const;
  Scalars start(Progress& progress, LaneArray& load, LaneArray& solution, int lanes);
  void take_guess(LaneArray& guess, LaneArray& residual);
  Scalars set_image(const LaneArray& vector);
  void subtract_image(const LaneArray& vector, LaneArray& residual);
  void iterate(Progress& progress, LaneArray& residual, LaneArray& solution, const LaneStop& stop);
  void precondition(const LaneArray& residual);
  void update_direction(const Scalars& beta, bool first);
  void add_diagonal(const LaneArray& vector, Scalars& products);
  Scalars advance(const Scalars& alpha, LaneArray& residual, LaneArray& solution);
  void balance(LaneArray& residual);
  /// Whether free_motions_ can be given.
  static constexpr bool may_be_free = Problem::own_operators && Width == 1;
  bool positive(int lane) const { return positive_[Problem::own_operators ? lane : 0]; }
  bool narrow(Progress& progress, LaneArray& residual, LaneArray& solution, const LaneStop& stop);

  LaneHierarchy<Problem::dim>& hierarchy_;
  const Problem& problem_;
  LaneCycle cycle_;
  std::unique_ptr<Operator> matrix_;
  std::unique_ptr<Multigrid> multigrid_;
  std::array<bool, Width> positive_{};
  LaneArray direction_, image_;
  LaneArray diagonal_;  ///< [node]; empty: none
  LaneValues<float> rounded_residual_, preconditioned_;
  std::unique_ptr<IslandMap<Problem::dim>> island_map_;
  IslandModes<Problem, Width> islands_;
  const FreeMotions<Problem::dim>* free_motions_ = nullptr;
  LaneArray corrected_, left_over_;              ///< of the rigid motions, if there are islands
  LaneArray handed_residual_, handed_solution_;  ///< of the lanes that a wider solver left over
  std::unique_ptr<Half> half_;                   ///< made at first use
};

/// Calls `use` with the narrowest solver for this many lanes, 1 to 8, and its width as template argument.
template <class Problem, class Use>
void with_narrowest(LaneCg<Problem, 8>& widest, int lanes, Use&& use) {
  if (lanes > 4)
    use.template operator()<8>(widest);
  else if (lanes > 2)
    use.template operator()<4>(widest.half());
  else if (lanes > 1)
    use.template operator()<2>(widest.half().half());
  else
    use.template operator()<1>(widest.half().half().half());
}

/// The solvers of all widths for a problem: instantiated by `template`, elsewhere by `extern template`, so
/// that the widest does not bring the code of the others along.
#define FABSEQ_EACH_LANE_CG(template_, Problem) \
  template_ class LaneCg<Problem, 8>;           \
  template_ class LaneCg<Problem, 4>;           \
  template_ class LaneCg<Problem, 2>;           \
  template_ class LaneCg<Problem, 1>
FABSEQ_EACH_LANE_CG(extern template, LaneElasticityProblem<2>);
FABSEQ_EACH_LANE_CG(extern template, LaneElasticityProblem<3>);
FABSEQ_EACH_LANE_CG(extern template, LaneHeatProblem<2>);
FABSEQ_EACH_LANE_CG(extern template, LaneHeatProblem<3>);

}  // namespace fabseq
