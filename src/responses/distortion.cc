// SPDX-License-Identifier: MIT
/// Objective and constraint: distortion (docs/formulation.md 5 and 7).
#include "responses/distortion_measures.h"

#include <cmath>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

/// The measure for one strain, with one component: J, in the length unit squared; of angle in degrees
/// squared. Throws InputError for a node set that the measure is not defined for.
template <int Dim>
std::unique_ptr<Response<Dim>> make_measure(const ResponseContext<Dim>& context,
                                            const DistortionSettings& settings) {
  if (settings.measure == Measure::layerwise) return make_layerwise<Dim>();
  const auto set_of = [&](const std::string& nodes) {
    return SetDisplacement<Dim>(context.part, context.node_sets.at(nodes), settings.after_release);
  };
  const SetDisplacement<Dim> set = set_of(settings.nodes);
  switch (settings.measure) {
    case Measure::flatness:
      return make_flatness(set, settings);
    case Measure::shape:
      return make_shape_deviation(set, settings);
    case Measure::angle:
      return make_angle_change(set, set_of(settings.to));
    default:
      return settings.norm ? make_displacement_norm(set, settings) : make_displacement(set, settings);
  }
}

/// The objective, J, aggregated over the scenarios.
template <int Dim>
struct Distortion {
  static std::unique_ptr<Response<Dim>> make(const ResponseContext<Dim>& context,
                                             const DistortionSettings& settings) {
    return aggregated(make_measure(context, settings), settings.aggregate,
                      settings.measure == Measure::layerwise);
  }
};

struct DistortionLimitSettings : DistortionSettings {
  double limit = 0.0;  ///< of the square root: length unit; of angle in degrees
};

/// The constraint: sqrt(J), at most `limit`; of the worst scenario a component for each. Where J is 0, the
/// root has a kink, and its derivative counts as 0, one of its subgradients.
template <int Dim>
class DistortionLimit : public Response<Dim> {
 public:
  DistortionLimit(const ResponseContext<Dim>& context, const DistortionLimitSettings& settings)
      : measure_(Distortion<Dim>::make(context, settings)), limit_(settings.limit) {
    if (auto each = measure_->largest_of()) measure_ = std::move(each);
  }

  bool uses_displacements() const override { return measure_->uses_displacements(); }

  std::vector<double> values(const StageResults<Dim>& state) const override {
    std::vector<double> result = measure_->values(state);
    for (double& value : result) value = std::sqrt(value);
    return result;
  }
  void add_derivative(int component, double weight, const StageResults<Dim>& state,
                      StageDerivatives<Dim>& adjoint) const override {
    const double root = values(state)[component];
    measure_->add_derivative(component, root > 0.0 ? weight / (2.0 * root) : 0.0, state, adjoint);
  }
  std::vector<ConstraintRow> rows(double margin) const override { return {{1.0, margin * limit_, limit_}}; }

 private:
  std::unique_ptr<Response<Dim>> measure_;
  double limit_;
};

Section<DistortionSettings> distortion_objective_keys() {
  return distortion_keys("objective")
      .key("least_squares", &DistortionSettings::least_squares,
           "Hand the term over as squares, an elastic adjoint each; auto: with scaling current, while they "
           "hold most of it",
           {.words = "auto"});
}

Section<DistortionLimitSettings> constraint_keys() {
  return Section<DistortionLimitSettings>("constraints")
      .keys([](DistortionLimitSettings& its) -> DistortionSettings& { return its; },
            distortion_keys("constraints"))
      .key("limit", &DistortionLimitSettings::limit,
           "Largest root of the measure, a length, of angle degrees",
           {.required = true, .range = "(0, inf)"});
}

const Registered<Distortion, DistortionSettings> objective({.name = "distortion",
                                                            .scaling = TermScaling::current},
                                                           distortion_objective_keys());
const Registered<DistortionLimit, DistortionLimitSettings> constraint({.list = TermList::constraints,
                                                                       .name = "distortion"},
                                                                      constraint_keys());

}  // namespace

}  // namespace fabseq
