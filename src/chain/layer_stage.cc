// SPDX-License-Identifier: MIT
#include "fabseq/chain/stage.h"

namespace fabseq {

namespace {

/// Pseudo-time and the layers' variables to the densities of stages and layers (docs/formulation.md 3).
template <int Dim>
class LayerStage : public Stage<Dim> {
 public:
  explicit LayerStage(StageContext<Dim>& context)
      : model_(context.layers),
        negligible_{context.tolerance * context.model.settings.process.min_stiffness,
                    context.model.settings.process.strain_penalty} {}

  void forward(const StageInput& input, StageResults<Dim>& results) override {
    layers_ = model_.make(input.design.layer_variables, input.beta, input.binary, negligible_);
    layers_->set_densities(results.time->time, densities_);
    results.layers = *layers_;
    results.densities = densities_;
  }
  void pull_back(const StageResults<Dim>& /*state*/, const SolveTolerance& /*tolerance*/,
                 AdjointRowSpan<Dim> rows) override {
    for (AdjointRow<Dim>* row : rows) row->sink.flush_all();
  }
  Phase phase() const override { return Phase::layers; }
  void release_memory() override { densities_ = {}; }

 private:
  const LayerModel<Dim>& model_;
  NegligibleLayers negligible_;  ///< part of the model: the same whatever the tolerance of a run
  std::unique_ptr<Layers> layers_;
  LayerDensities densities_;
};

/// Each group has all densities.
StageCost cost_of_layers(const RunSize& size, SolverPath /*path*/, int groups, int /*lanes*/) {
  return {.held = size.part_elements * size.layers * 16.0 * groups};
}

const RegisteredStage<LayerStage> layer_stage{
    {"layers", {&Results::time}, {&Results::densities, &Results::layers}}, cost_of_layers};

}  // namespace

}  // namespace fabseq
