// SPDX-License-Identifier: MIT
#include "fabseq/optimize/stage.h"
#include "fabseq/process/inherent_strain.h"

namespace fabseq {

namespace {

/// Directions of the layers to inherent strains that turn with them (docs/formulation.md 4.2).
template <int Dim>
class StrainStage : public Stage<Dim> {
 public:
  /// Null if the strain does not turn.
  static std::unique_ptr<Stage<Dim>> make(StageContext<Dim>& context) {
    if (!context.model.settings.material.turning_strain) return nullptr;
    return std::make_unique<StrainStage>(context);
  }
  explicit StrainStage(StageContext<Dim>& context)
      : groups_(context.model.groups),
        strain_(context.model.settings.material, context.model.characteristic_length) {}

  void forward(const StageInput& /*input*/, StageResults<Dim>& results) override {
    results.strains = strain_.strains(results.time->gradient, *results.layers);
  }
  void pull_back(const PipelineState<Dim>& state, const SolveTolerance& /*tolerance*/,
                 AdjointRowSpan<Dim> rows) override {
    for (AdjointRow<Dim>* row : rows) {
      if (!row->shared) continue;
      PipelineAdjoint<Dim>& adjoint = row->adjoint;
      strain_.pull_back(state.time.gradient, state.layers, adjoint.strains, adjoint.time.gradient,
                        adjoint.densities);
      if (adjoint.densities.directions.empty()) groups_.sum_at(row->owner, adjoint.time.gradient);
    }
  }
  Phase phase() const override { return Phase::primal; }
  Phase adjoint_phase() const override { return Phase::layers; }

 private:
  const LayerGroups& groups_;
  InherentStrain<Dim> strain_;
};

StageCost no_cost(const RunSize&, SolverPath, int, int) { return {}; }

const RegisteredStage<StrainStage> strain_stage{{"strain", {"time", "layers"}, {"strains"}}, no_cost};

}  // namespace

}  // namespace fabseq
