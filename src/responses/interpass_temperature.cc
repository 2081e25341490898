// SPDX-License-Identifier: MIT
/// Constraint: no layer begins on ground that is too hot (docs/formulation.md 14.2).
#include "fabseq/responses/response_type.h"

namespace fabseq {

namespace {

struct InterpassTemperatureSettings {
  double limit = 0.0;  ///< degrees Celsius

  void check(const TermPlace& place) const {
    if (!place.thermal)
      refuse(pointer_to(place.pointer, "type"), "\"interpass_temperature\" without a block thermal",
             "this type with a block thermal");
    if (limit <= place.thermal->ambient)
      refuse(pointer_to(place.pointer, "limit"), shown(limit),
             "more than thermal.ambient, " + shown(place.thermal->ambient));
  }
};

/// B_2 to B_N, the temperatures at which all layers but the first begin, degrees Celsius.
template <int Dim>
class InterpassTemperature : public Response<Dim> {
 public:
  InterpassTemperature(const ResponseContext<Dim>& context, const InterpassTemperatureSettings& settings)
      : ambient_(context.thermal.value().ambient), limit_(settings.limit) {}

  std::vector<double> values(const StageResults<Dim>& state) const override {
    const std::vector<double>& interpass = state.temperatures->interpass;
    return {interpass.begin() + 1, interpass.end()};
  }

  void add_derivative(int component, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    adjoint.temperatures.zeros_if_empty(state.densities->count())[component + 1] += weight;
  }

  /// Relative to what the limit allows above the air.
  std::vector<ConstraintRow> rows(double margin) const override {
    return {{1.0, ambient_ + margin * (limit_ - ambient_), limit_ - ambient_}};
  }

 private:
  double ambient_, limit_;
};

const Registered<InterpassTemperature, InterpassTemperatureSettings> registered(
    {.list = TermList::constraints, .name = "interpass_temperature", .unit = "degrees C"},
    Section<InterpassTemperatureSettings>("constraints")
        .key("limit", &InterpassTemperatureSettings::limit,
             "Highest mean temperature of a layer when the next one begins",
             {.required = true, .range = "(-273.15, inf)", .unit = "degrees C"}));

}  // namespace

}  // namespace fabseq
