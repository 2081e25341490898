// SPDX-License-Identifier: MIT
/// Objective: distortion (docs/formulation.md 5).
#include "fabseq/responses/distortion.h"

#include "fabseq/responses/distortion_measures.h"

namespace fabseq {

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

FABSEQ_INSTANTIATE_FUNCTION(make_measure);

namespace {

template <int Dim>
struct Distortion {
  static std::unique_ptr<Response<Dim>> make(const ResponseContext<Dim>& context,
                                             const DistortionSettings& settings) {
    return make_measure(context, settings);
  }
};

Section<DistortionSettings> objective_keys() {
  return distortion_keys("objective")
      .key("least_squares", &DistortionSettings::least_squares,
           "Hand displacement, flatness or shape to the optimizer as a sum of squares, an elastic adjoint "
           "each; auto: with scaling current, while these hold most of it",
           {.words = "auto"});
}

const Registered<Distortion, DistortionSettings> registered({.name = "distortion",
                                                             .scaling = TermScaling::current},
                                                            objective_keys());

}  // namespace

}  // namespace fabseq
