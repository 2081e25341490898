// SPDX-License-Identifier: MIT
/// \file
/// The design a run ends with: the best feasible iterate at the last sharpness (docs/formulation.md 9).
#pragma once

#include "fabseq/files/checkpoint_state.h"
#include "fabseq/optimize/design.h"
#include "fabseq/optimize/iterate.h"

#include <string>
#include <utility>

namespace fabseq {

/// Keeps the best of the designs offered so far: the one whose constraints stand best, then the one of
/// smaller merit; where constraints are violated, the smaller violation counts first, and where it is the
/// same (all that it depends on may be fixed) the merit. Local to the rank; ranks agree because values do.
class BestIterate {
 public:
  /// `layer_variables`: their name, for checkpoints.
  explicit BestIterate(std::string layer_variables) : layer_variables_(std::move(layer_variables)) {}

  /// Designs at another sharpness cannot be compared, nor those judged by other layers: a new `beta`, or the
  /// first that is judged by binary layers, starts over.
  void offer(const Iterate& iterate, const Design& design);

  int iteration() const { return iteration_; }
  double beta() const { return beta_; }
  double worst_constraint() const { return worst_constraint_; }
  bool feasible() const { return standing_ == Standing::satisfied; }
  const Design& design() const { return design_; }

  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

 private:
  std::string layer_variables_;
  int iteration_ = 0;
  bool by_binary_ = false;  ///< judged by binary layers
  Standing standing_ = Standing::violated;
  double beta_ = 0.0, worst_constraint_ = 0.0, merit_ = 0.0;
  Design design_;
};

}  // namespace fabseq
