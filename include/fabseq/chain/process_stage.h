// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/chain/stage.h"
#include "fabseq/process/process.h"

#include <memory>
#include <optional>
#include <vector>

namespace fabseq {

/// Densities and strains to displacements (docs/formulation.md 4). Groups share the layers.
template <int Dim>
class ProcessStage : public Stage<Dim> {
 public:
  explicit ProcessStage(StageContext<Dim>& context);

  Process<Dim>& process() { return *process_; }

  void forward(const StageInput& input, StageResults<Dim>& results) override;
  void pull_back(const StageResults<Dim>& state, const SolveTolerance& tolerance,
                 AdjointRowSpan<Dim> rows) override;
  Phase phase() const override { return Phase::primal; }
  Phase adjoint_phase() const override { return Phase::adjoint; }
  void start_cold() override { process_->start_cold(); }
  void release_memory() override { process_->release_memory(); }
  /// Saves by what work the layers are dealt out next.
  void save(CheckpointState& state) const override;
  void restore(const CheckpointState& state) override;
  void add_iterations(SolverIterations& iterations) const override;

 private:
  ElasticModel<Dim> elastic_;
  std::unique_ptr<Process<Dim>> process_;
  bool flows_;                                ///< beyond a yield stress: all elements count throughout
  StepTemperatures temperatures_;             ///< of the last simulation, with them
  std::optional<ThermalProperties> thermal_;  ///< of the steps' temperatures, where the material flows
  std::vector<int> forward_iterations_, adjoint_iterations_;
};

}  // namespace fabseq
