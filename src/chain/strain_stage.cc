// SPDX-License-Identifier: MIT
#include "fabseq/chain/stage.h"
#include "fabseq/process/inherent_strain.h"

#include <span>
#include <vector>

namespace fabseq {

namespace {

/// The inherent strain as the source of strains (docs/formulation.md 4.2): it may turn with the directions of
/// the layers, and layers get a share of it by the temperatures at which they begin (14.2).
template <int Dim>
class StrainStage : public Stage<Dim> {
 public:
  explicit StrainStage(StageContext<Dim>& context)
      : strain_(context.model.settings.material, context.model.characteristic_length) {}

  void forward(const StageInput& /*input*/, StageResults<Dim>& results) override {
    strain_.set(results.time->gradient, *results.densities,
                results.temperatures ? std::span<const double>(results.temperatures->share)
                                     : std::span<const double>());
    results.strains = strain_;
  }
  void pull_back(const StageResults<Dim>& state, const SolveTolerance& /*tolerance*/,
                 AdjointRowSpan<Dim> rows) override {
    for (AdjointRow<Dim>* row : rows) {
      if (!row->shared) continue;
      StageDerivatives<Dim>& adjoint = row->adjoint;
      if (state.temperatures) pull_back_share(*state.temperatures, adjoint);
      if (!strain_.turns()) continue;
      strain_.pull_back(state.time->gradient, *state.densities, adjoint.strains.inputs, adjoint.time.gradient,
                        adjoint.densities);
      adjoint.time.gradient_in_parts = adjoint.densities.directions.empty();
    }
  }
  Phase phase() const override { return Phase::primal; }
  Phase adjoint_phase() const override { return Phase::layers; }

 private:
  void pull_back_share(const LayerTemperatures& temperatures, StageDerivatives<Dim>& adjoint) const {
    const std::span<const double> d_share = strain_.of_shares(adjoint.strains.inputs);
    std::vector<double>& d_interpass = adjoint.temperatures.zeros_if_empty(temperatures.count());
    for (std::size_t j = 0; j < d_share.size(); ++j)
      d_interpass[j] += temperatures.share_slope[j] * d_share[j];
  }

  InherentStrain<Dim> strain_;
};

StageCost no_cost(const RunSize&, SolverPath, int, int) { return {}; }

const RegisteredStage<StrainStage> strain_stage{
    {"strain", {&Results::time, &Results::densities, &Results::temperatures}, {&Results::strains}}, no_cost};

}  // namespace

}  // namespace fabseq
