// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/checkpoint_state.h"
#include "fabseq/optimize/optimizer_settings.h"

#include <string>
#include <vector>

namespace fabseq {

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

}  // namespace fabseq
