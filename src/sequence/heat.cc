// SPDX-License-Identifier: MIT
/// Sequences of type "heat" (docs/formulation.md 2.1, 2.2).
#include "fabseq/base/refusal.h"
#include "fabseq/sequence/sequence_kind.h"
#include "sequence/drain_length.h"
#include "sequence/heat_sequence.h"

namespace fabseq {

namespace {

struct HeatKind {
  using Settings = HeatSettings;

  static Section<Settings> keys() {
    using Its = Settings;
    const Settings defaults;
    return Section<Its>("sequence")
        .key("scale", &Its::scale, "Scale on which the optimizer moves the diffusivity",
             {.words = "log linear", .option = "-scale"})
        .key("mass", &Its::mass,
             "Mass matrix of the drain; auto: lumped where the consistent one would undershoot",
             {.words = "auto consistent lumped", .option = "-mass"})
        .key("initial", &Its::initial, "Initial diffusivity, uniform or from the distance to the plate",
             {.range = "(0, inf)", .words = "distance"})
        .key("drain", &Its::drain, "Drain, over the square of characteristic_length",
             {.range = "(0, inf)", .option = "-drain"})
        .key("characteristic_length", &Its::characteristic_length,
             "auto: number of layers times the target thickness, more above a narrow foot; else the part's "
             "longest edge",
             {.range = "(0, inf)", .words = "auto", .unit = "length", .option = "-characteristic_length"})
        .key("bounds", "Least and largest diffusivity in the part",
             {.type = KeyType::bounds,
              .default_value = to_text(Json{defaults.min_diffusivity, defaults.max_diffusivity}),
              .range = "(0, inf)"},
             [](Its& sequence, const Json& value, const KeyPlace&) {
               value[0].get_to(sequence.min_diffusivity);
               value[1].get_to(sequence.max_diffusivity);
             })
        .key("void", &Its::void_diffusivity, "Diffusivity outside the part", {.range = "(0, inf)"})
        .key("filter_radius", &Its::filter_radius, "Radius of the averaging filter; 0: none",
             {.range = "[0, inf)", .unit = "length", .option = "-filter_radius"});
  }

  static void check(const Settings& settings, const Json& keys) {
    if (!settings.initial) return;
    if (*settings.initial >= settings.min_diffusivity && *settings.initial <= settings.max_diffusivity)
      return;
    refuse("/sequence/initial", shown(keys.at("initial")),
           "\"distance\" or a number within bounds " + shown(keys.at("bounds")));
  }

  /// Move limits: measured on the log scale, published for diffusivities themselves.
  static SequenceFacts facts(const Settings& settings) {
    const bool logarithmic = settings.scale == VariableScale::log;
    return {.move_limits = logarithmic ? MoveLimits{0.05, 0.004} : MoveLimits{0.2, std::nullopt},
            .characteristic_length = settings.characteristic_length};
  }

  template <int Dim>
  static void fix_lengths(Settings& settings, const Part<Dim>& part, double height_of_layers) {
    if (settings.characteristic_length) return;
    settings.characteristic_length =
        height_of_layers > 0.0 ? drain_length(part, settings, height_of_layers) : part.longest_edge();
  }

  template <int Dim>
  static SequencePlaces<Dim> places(const Settings& /*settings*/, const Part<Dim>& part) {
    return {DesignSupport<Dim>(part.grid(), false, part.elements())};
  }

  template <int Dim>
  static std::unique_ptr<Sequence<Dim>> make(const Settings& settings, const SequenceContext<Dim>& context) {
    auto heat = std::make_unique<const HeatModel<Dim>>(context.part, settings);
    auto solver = context.make_heat_solver(heat->domain, heat->lumped);
    return std::make_unique<HeatSequence<Dim>>(context.part, settings, context.target_gradient,
                                               std::move(heat), std::move(solver), context.across,
                                               context.lanes);
  }
};

const RegisteredSequence<HeatKind> registered({.name = "heat",
                                               .position = 1,
                                               .has_design = true,
                                               .with_gradient = "heat",
                                               .bounds_key = "bounds",
                                               .move_limits = "0.05 on the log, 0.2 on the linear scale",
                                               .last_move_limits = "0.004 on the log scale"});

}  // namespace

}  // namespace fabseq
