// SPDX-License-Identifier: MIT
/// Constraint: the volume of every stage keeps pace with its time point (docs/formulation.md 7).
#include "fabseq/base/mpi.h"
#include "fabseq/responses/response_type.h"

namespace fabseq {

namespace {

struct DepositionSpeedSettings {
  double slack = 1e-3;
};

/// One component per stage j = 1 ... N - 1: V_j / V* - T_j, between -slack and 0. V_j is the volume of the
/// stage.
template <int Dim>
class DepositionSpeed : public Response<Dim> {
 public:
  DepositionSpeed(const ResponseContext<Dim>& context, const DepositionSpeedSettings& settings)
      : context_(context), slack_(settings.slack) {}

  std::vector<double> values(const StageResults<Dim>& state) const override {
    std::vector<double> result(state.densities->count() - 1, 0.0);
    for (std::size_t j = 0; j < result.size(); ++j)
      for (const double density : state.densities->stage[j]) result[j] += density * volume_fraction();
    sum_in_place(context_.part.grid().comm(), result);
    for (std::size_t j = 0; j < result.size(); ++j) result[j] -= state.densities->time_points[j + 1];
    return result;
  }

  void add_derivative(int component, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    auto& d_stage = DensityDerivatives::zeros_if_empty(adjoint.densities.stage[component],
                                                       state.densities->stage[component].size());
    for (double& derivative : d_stage) derivative += weight * volume_fraction();
    adjoint.densities.time_points_or_zeros()[component + 1] -= weight;
  }

  std::vector<ConstraintRow> rows(double margin) const override {
    return {{1.0, -0.5 * (1.0 - margin) * slack_}, {-1.0, -0.5 * (1.0 + margin) * slack_}};
  }

 private:
  /// Volume of an element relative to that of the part.
  double volume_fraction() const { return context_.part.grid().element_volume() / context_.part.volume(); }

  ResponseContext<Dim> context_;
  double slack_;
};

const Registered<DepositionSpeed, DepositionSpeedSettings> registered(
    {.list = TermList::constraints, .name = "deposition_speed", .layers = LayerKind::curved},
    Section<DepositionSpeedSettings>("constraints")
        .key("slack", &DepositionSpeedSettings::slack,
             "How far the volume may lag behind, relative to the part's", {.range = "(0, 1)"}));

}  // namespace

}  // namespace fabseq
