// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/optimize/best_iterate.h"
#include "fabseq/optimize/continuation.h"
#include "fabseq/optimize/convergence.h"
#include "fabseq/optimize/design_update.h"
#include "fabseq/optimize/optimizer_settings.h"

#include <string>

namespace fabseq {

/// Returns the tolerances of an iteration's solves, from 1e-2 to the finest
/// (docs/developer/optimizer.md 9.4). Errors of displacements are a share of what the step changes, those of
/// gradients a percent or two, and those of the values by which iterates are compared a fraction of a
/// percent. Not collective.
///
/// \param move_limit  largest step of a variable, as a share of its range
/// \param share_left  of the first distortion, a sum of squares, from 0 to 1: what cancellation leaves has
///                    the errors of what was there before
Tolerances following_tolerances(double move_limit, double share_left);

/// How a run ended.
struct RunEnd {
  std::string status;  ///< converged, iteration_limit, stopped, failed
  std::string reason;
  int iterations = 0;
};

/// The design and whatever remembers earlier iterations. A state that is saved and restored, be it on another
/// number of ranks or layer groups, goes on like the first. Collective construction.
template <int Dim>
class RunState {
 public:
  /// Begins before the first iteration. `design`: to start from; model and settings must outlive the state.
  RunState(const Model<Dim>& model, const OptimizerSettings& settings, const Sequence<Dim>& sequence,
           Design design);

  Problem<Dim> problem;
  Continuation continuation;
  DesignUpdate optimizer;
  BestIterate best;

  /// What the next iteration evaluates.
  const Design& design() const { return design_; }
  /// Iterations done.
  int completed() const { return completed_; }
  /// Returns the tolerances of the solves of the next iteration.
  Tolerances tolerances() const;
  /// Ends an iteration, whose design had these values and whose step to the `next` one was `change`
  /// (StepReport::change).
  void complete(Design next, double change, const ProblemValues& values);
  /// Whether there is nothing left to do: converged, or as many iterations as were asked for; and nothing to
  /// be repaired, or as many iterations for that.
  bool ended() const {
    return (!convergence().empty() || completed_ >= settings_.max_iterations) && !repairs();
  }
  /// How, once it has.
  RunEnd end() const;

  /// Collective.
  CheckpointState save() const;
  void restore(const CheckpointState& state);

 private:
  /// Whether iterations that repair the best iterate are left.
  bool repairs() const {
    return best.fails_checks() && completed_ < settings_.max_iterations + settings_.repair_iterations;
  }
  /// Why the run could end before its last iteration, empty while it should go on.
  std::string convergence() const;

  const Model<Dim>& model_;
  const OptimizerSettings& settings_;
  Design design_;
  Convergence convergence_;
  int completed_ = 0;
  double share_left_ = 1.0;  ///< Problem::share_left() of the last iteration
};

}  // namespace fabseq
