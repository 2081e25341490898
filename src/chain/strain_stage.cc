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
      : groups_(context.model.groups),
        strain_(context.model.settings.material, context.model.characteristic_length) {}

  void forward(const StageInput& /*input*/, StageResults<Dim>& results) override {
    strain_.set(results.time->gradient, *results.densities,
                results.temperatures != nullptr ? std::span<const double>(results.temperatures->share)
                                                : std::span<const double>());
    results.strains = &strain_;
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
    const std::span<const double> d_share = strain_.of_shares(adjoint.strains);
    std::vector<double>& d_interpass = adjoint.interpass_or_zeros(temperatures.count());
    for (std::size_t j = 0; j < d_share.size(); ++j)
      d_interpass[j] += temperatures.share_slope[j] * d_share[j];
  }

  const LayerGroups& groups_;
  InherentStrain<Dim> strain_;
};

StageCost no_cost(const RunSize&, SolverPath, int, int) { return {}; }

const RegisteredStage<StrainStage> strain_stage{{"strain", {"time", "layers", "temperatures"}, {"strains"}},
                                                no_cost};

}  // namespace

}  // namespace fabseq
