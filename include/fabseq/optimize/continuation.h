// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/checkpoint_state.h"
#include "fabseq/layers/layer_settings.h"
#include "fabseq/optimize/optimizer_settings.h"

#include <algorithm>

namespace fabseq {

/// What changes with the iteration number alone: the layers' sharpness and the move limit
/// (docs/formulation.md 3.1, 9). Iterations count from 1; those that were done before it, such as on a coarse
/// grid, are added here.
class Continuation {
 public:
  /// \param first_beta, last_beta sharpness at the start and the most it grows to
  Continuation(const ProjectionSettings& projection, double first_beta, double last_beta,
               const OptimizerSettings& optimizer);

  /// Sharpness: every `interval` iterations beta * factor + increment, at most the last. It stays in
  /// iterations that repair, after `max_iterations`.
  double beta(int iteration) const { return scheduled_beta(std::min(iteration, optimizer_.max_iterations)); }
  /// Whether the sharpness will not change any more, in this run of `max_iterations`.
  bool at_last_beta(int iteration) const;
  /// Whether this run of `max_iterations` gets to where the sharpness ends.
  bool reaches_the_end() const {
    return scheduled_beta(optimizer_.max_iterations + projection_.interval) ==
           beta(optimizer_.max_iterations);
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
  /// Whether the iteration is one of the last tenth of all that were planned.
  bool near_the_end(int iteration) const;

  /// The number of iterations, earlier and later ones included, that the move limit was planned for: a run
  /// that continues with another number of iterations goes on as planned.
  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

 private:
  double scheduled_beta(int iteration) const;
  /// Share of the planned iterations that are done with this one.
  double progress(int iteration) const {
    return static_cast<double>(earlier_iterations_ + iteration) / planned_iterations_;
  }

  ProjectionSettings projection_;
  double first_beta_, last_beta_;
  OptimizerSettings optimizer_;
  int earlier_iterations_, planned_iterations_;
};

}  // namespace fabseq
