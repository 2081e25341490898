// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/chain/stage.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace fabseq {

/// Design to pseudo-time (docs/formulation.md 2).
template <int Dim>
class SequenceStage : public Stage<Dim> {
 public:
  explicit SequenceStage(StageContext<Dim>& context);

  /// Returns the sequence for any use: the next forward() solves again.
  Sequence<Dim>& sequence() {
    solved_.reset();
    return *sequence_;
  }

  void forward(const StageInput& input, StageResults<Dim>& results) override;
  void pull_back(const StageResults<Dim>& state, const SolveTolerance& tolerance,
                 AdjointRowSpan<Dim> rows) override;
  bool runs_in_owner_group() const override { return true; }
  Phase phase() const override { return Phase::heat; }
  void start_cold() override {
    solved_.reset();
    sequence_->start_cold();
  }
  void release_memory() override {
    solved_.reset();
    sequence_->release_memory();
  }
  void add_iterations(SolverIterations& iterations) const override;

 private:
  /// What the last forward() solved, and how closely.
  struct Solved {
    std::vector<double> design;  ///< this rank's share
    SolveTolerance tolerance;
    const PseudoTime<Dim>* time = nullptr;  ///< the sequence's
  };

  /// Collective on the world of the groups.
  bool is_solved(const std::vector<double>& design, const SolveTolerance& tolerance) const;

  const LayerGroups& groups_;
  std::unique_ptr<Sequence<Dim>> sequence_;
  std::optional<Solved> solved_;
  std::vector<int> iterations_;  ///< of the forward solve, if there was one
};

}  // namespace fabseq
