// SPDX-License-Identifier: MIT
#include "fabseq/optimize/stage.h"
#include "fabseq/process/inherent_strain.h"

namespace fabseq {

namespace {

/// Directions of the layers to inherent strains that turn with them (docs/formulation.md 4.2), and
/// temperatures at which layers begin to the share that they get of it (14.2).
template <int Dim>
class StrainStage : public Stage<Dim> {
 public:
  /// Null if the strain is the same in all elements and layers.
  static std::unique_ptr<Stage<Dim>> make(StageContext<Dim>& context) {
    const ModelSettings& settings = context.model.settings;
    if (!settings.material.turning_strain && !settings.thermal) return nullptr;
    return std::make_unique<StrainStage>(context);
  }
  explicit StrainStage(StageContext<Dim>& context)
      : groups_(context.model.groups),
        strain_(context.model.settings.material, context.model.characteristic_length) {}

  void forward(const StageInput& /*input*/, StageResults<Dim>& results) override {
    results.strains = strain_.strains(results.time->gradient, *results.layers);
    if (results.temperatures == nullptr) return;
    full_ = results.strains;
    scale_layers<Dim>(results.temperatures->share, results.strains);
  }
  void pull_back(const PipelineState<Dim>& state, const SolveTolerance& /*tolerance*/,
                 AdjointRowSpan<Dim> rows) override {
    for (AdjointRow<Dim>* row : rows) {
      if (!row->shared) continue;
      PipelineAdjoint<Dim>& adjoint = row->adjoint;
      if (state.temperatures != nullptr) pull_back_share(*state.temperatures, adjoint);
      if (!strain_.turns()) continue;
      strain_.pull_back(state.time.gradient, state.layers, adjoint.strains, adjoint.time.gradient,
                        adjoint.densities);
      if (adjoint.densities.directions.empty()) groups_.sum_at(row->owner, adjoint.time.gradient);
    }
  }
  Phase phase() const override { return Phase::primal; }
  Phase adjoint_phase() const override { return Phase::layers; }

 private:
  void pull_back_share(const LayerTemperatures& temperatures, PipelineAdjoint<Dim>& adjoint) const {
    const std::vector<double> d_share =
        pull_back_layer_scale<Dim>(full_, temperatures.share, adjoint.strains);
    std::vector<double>& d_interpass = adjoint.touch_interpass(temperatures.count());
    for (std::size_t j = 0; j < d_share.size(); ++j)
      d_interpass[j] += temperatures.share_slope[j] * d_share[j];
  }

  const LayerGroups& groups_;
  InherentStrain<Dim> strain_;
  StrainField full_;  ///< before the share of each layer
};

StageCost no_cost(const RunSize&, SolverPath, int, int) { return {}; }

const RegisteredStage<StrainStage> strain_stage{{"strain", {"time", "layers", "temperatures"}, {"strains"}},
                                                no_cost};

}  // namespace

}  // namespace fabseq
