// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/checkpoint_state.h"
#include "fabseq/layers/layer_settings.h"
#include "fabseq/optimize/best_iterate.h"
#include "fabseq/optimize/design_update.h"
#include "fabseq/optimize/optimizer_settings.h"

#include <string>
#include <vector>

namespace fabseq {

/// What changes with the iteration number alone: the layers' sharpness and the move limit
/// (docs/formulation.md 3.1, 9). Iterations count from 1; those that were done before it, such as on a coarse
/// grid, are added here.
class Continuation {
 public:
  /// \param first_beta, last_beta sharpness at the start and the most it grows to
  Continuation(const ProjectionSettings& projection, double first_beta, double last_beta,
               const OptimizerSettings& optimizer);

  /// Sharpness: every `interval` iterations beta * factor + increment, at most the last.
  double beta(int iteration) const;
  /// Whether the sharpness will not change any more, in this run of `max_iterations`.
  bool at_last_beta(int iteration) const;
  /// Whether this run of `max_iterations` gets to where the sharpness ends.
  bool reaches_the_end() const {
    return beta(optimizer_.max_iterations + projection_.interval) == beta(optimizer_.max_iterations);
  }
  /// Whether the iterate is judged by its binary layers: one of the last `binary_iterations` of all, but
  /// never the first, by whose smooth layers terms are scaled.
  bool judges_binary(int iteration) const {
    return iteration > 1 && optimizer_.later_iterations == 0 &&
           iteration > optimizer_.max_iterations - optimizer_.binary_iterations;
  }
  /// Largest step as a fraction of the variable's range: constant for 40 % of the run, then falling
  /// geometrically.
  double move_limit(int iteration) const;

  /// The number of iterations, earlier and later ones included, that the move limit was planned for: a run
  /// that continues with another number of iterations goes on as planned.
  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

 private:
  ProjectionSettings projection_;
  double first_beta_, last_beta_;
  OptimizerSettings optimizer_;
  int earlier_iterations_, planned_iterations_;
};

/// Watches design and objective over the last `window` iterations at one sharpness, to say when a run is done
/// (docs/formulation.md 9). Local to the rank; ranks agree because values do.
class Convergence {
 public:
  /// `merit_unit`: what changes of the merit are relative to.
  Convergence(const OptimizerSettings& optimizer, double merit_unit);

  /// An iteration: its sharpness, the largest change of a variable (fraction of its range), the merit of the
  /// design it evaluated (ProblemValues::merit). Another `beta` starts over.
  void add(double beta, double change, double merit);
  /// Why the run could end, in words; empty while it should go on. `feasible`: whether there is a feasible
  /// iterate at this sharpness; before that an objective that stays means nothing.
  std::string reason(bool feasible) const;

  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

 private:
  bool window_is_full() const { return changes_.size() == static_cast<std::size_t>(optimizer_.window); }

  OptimizerSettings optimizer_;
  double merit_unit_;
  double beta_ = 0.0;
  std::vector<double> changes_, merits_;  ///< of the window, the oldest first
};

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
  /// Before the first iteration. `design`: to start from; model and settings must outlive the state.
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
  /// Ends an iteration, whose design had these values and whose step to the `next` one was `change`
  /// (StepReport::change).
  void complete(Design next, double change, const ProblemValues& values);
  /// Whether there is nothing left to do: converged, or as many iterations as were asked for.
  bool ended() const { return !convergence().empty() || completed_ >= settings_.max_iterations; }
  /// How, once it has.
  RunEnd end() const;

  /// Collective.
  CheckpointState save() const;
  void restore(const CheckpointState& state);

 private:
  /// Why the run could end before its last iteration, empty while it should go on.
  std::string convergence() const;

  const OptimizerSettings& settings_;
  const LayerVariables& layer_variables_;
  Design design_;
  Convergence convergence_;
  int completed_ = 0;
};

}  // namespace fabseq
