// SPDX-License-Identifier: MIT
/// Objective and constraint: the time that the build takes (docs/formulation.md 14.2).
#include "fabseq/responses/layer_statistics.h"
#include "fabseq/responses/response_type.h"

#include <cmath>
#include <numeric>

namespace fabseq {

namespace {

/// Volume of a sliver relative to the mean of all layers: a layer of that size counts by 1 - 1/e.
constexpr double sliver = 0.05;

/// Settings of both lists; an objective has no limit.
struct BuildTimeSettings {
  double limit = 0.0;  ///< hours

  void check(const TermPlace& place) const {
    if (!place.clock)
      refuse(pointer_to(place.pointer, "type"),
             "\"build_time\" without material.mass_density and process.deposition_rate",
             "this type with both");
  }
};

/// Hours of welding and of the pauses behind layers that hold something: a layer of volume V counts as
/// 1 - exp(-V N / (0.05 V*)), which is steep for a sliver only.
template <int Dim>
class BuildTime : public Response<Dim> {
 public:
  BuildTime(const ResponseContext<Dim>& context, const BuildTimeSettings& settings)
      : grid_(context.part.grid()),
        volume_(context.part.volume()),
        clock_(context.clock.value()),
        limit_(settings.limit) {}

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const std::vector<double> volume = layer_volumes(grid_, *state.densities);
    double used = 0.0;
    for (const double of_layer : volume) used -= std::expm1(-of_layer / sliver_of(state));
    return {clock_.hours(std::accumulate(volume.begin(), volume.end(), 0.0), used)};
  }

  void add_derivative(int /*component*/, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const std::vector<double> volume = layer_volumes(grid_, *state.densities);
    for (int j = 0; j < state.densities->count(); ++j) {
      const double used = std::exp(-volume[j] / sliver_of(state)) / sliver_of(state);
      const double derivative = weight * grid_.element_volume() * clock_.hours(1.0, used);
      auto& d_layer =
          DensityDerivatives::zeros_if_empty(adjoint.densities.layer[j], state.densities->layer[j].size());
      for (double& of_element : d_layer) of_element += derivative;
    }
  }

  /// Only the pauses can be had for less: the margin refers to them.
  std::vector<ConstraintRow> rows(double margin) const override {
    const double welding = clock_.hours(volume_, 0.0);
    return {{1.0, welding + margin * (limit_ - welding), limit_}};
  }

 private:
  /// Volume that a layer is held against.
  double sliver_of(const StageResults<Dim>& state) const {
    return sliver * volume_ / state.densities->count();
  }

  const Grid<Dim>& grid_;
  double volume_;
  BuildClock clock_;
  double limit_;
};

const Registered<BuildTime, BuildTimeSettings> objective({.list = TermList::objective, .name = "build_time"},
                                                         Section<BuildTimeSettings>("objective"));
const Registered<BuildTime, BuildTimeSettings> constraint(
    {.list = TermList::constraints, .name = "build_time", .unit = "h"},
    Section<BuildTimeSettings>("constraints")
        .key("limit", &BuildTimeSettings::limit,
             "Longest time of the build, welding and pauses; needs material.mass_density and "
             "process.deposition_rate",
             {.required = true, .range = "(0, inf)", .unit = "h"}));

}  // namespace

}  // namespace fabseq
