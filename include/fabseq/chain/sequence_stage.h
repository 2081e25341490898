// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/chain/stage.h"

#include <memory>
#include <span>
#include <vector>

namespace fabseq {

/// Design to pseudo-time (docs/formulation.md 2).
template <int Dim>
class SequenceStage : public Stage<Dim> {
 public:
  explicit SequenceStage(StageContext<Dim>& context);

  Sequence<Dim>& sequence() { return *sequence_; }

  void forward(const StageInput& input, StageResults<Dim>& results) override;
  void pull_back(const StageResults<Dim>& state, const SolveTolerance& tolerance,
                 AdjointRowSpan<Dim> rows) override;
  bool runs_in_owner_group() const override { return true; }
  Phase phase() const override { return Phase::heat; }
  void start_cold() override { sequence_->start_cold(); }
  void release_memory() override { sequence_->release_memory(); }
  void add_iterations(SolverIterations& iterations) const override;

 private:
  const LayerGroups& groups_;
  std::unique_ptr<Sequence<Dim>> sequence_;
  std::vector<int> iterations_;  ///< of the forward solve, if there was one
};

}  // namespace fabseq
