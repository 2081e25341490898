// SPDX-License-Identifier: MIT
/// Sequences of type "guided" (docs/formulation.md 2.4).
#include "fabseq/base/refusal.h"
#include "fabseq/keys/direction.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "fabseq/sequence/sequence_kind.h"
#include "sequence/guided_problem.h"
#include "sequence/guided_sequence.h"
#include "sequence/guided_settings.h"
#include "sequence/guided_start.h"

namespace fabseq {

namespace {

struct GuidedKind {
  using Settings = GuidedSettings;

  static Section<Settings> keys() {
    using Its = Settings;
    return Section<Its>("sequence")
        .key("max_tilt", &Its::given_max_tilt,
             "Bound of each component of the tilt from the plate's normal; auto: tool.max_tilt below 90, "
             "else 60",
             {.range = "(0, 90]", .words = "auto", .unit = "degrees"})
        .key("stretch",
             "Least and largest local thickness over the target; none: no variable; auto: tool.thickness "
             "with a torch, else none",
             {.type = KeyType::bounds,
              .default_value = to_text("auto"),
              .range = "(0, inf)",
              .words = "auto none"},
             read_stretch)
        .key("filter_radius", &Its::filter_radius,
             "Radius of the averaging filter; 0: none; auto: twice the longest edge",
             {.range = "[0, inf)", .words = "auto", .unit = "length"})
        .key("void", &Its::void_diffusivity, "Diffusivity outside the part; 1 inside", {.range = "(0, inf)"})
        .key("characteristic_length", &Its::characteristic_length,
             "auto: number of layers times the target thickness, else the geodesic height",
             {.range = "(0, inf)", .words = "auto", .unit = "length"})
        .key("initial",
             "Initial build directions: of the distance to the plate, the plate's normal, or a vector",
             {.type = KeyType::vector, .default_value = to_text("distance"), .words = "distance planar"},
             read_start);
  }

  static void check(const Settings& settings, const Json& keys) {
    if (settings.start == GuidedStart::direction)
      check_direction("/sequence/initial", keys.at("initial"), settings.direction, {"distance"});
    const auto& stretch = settings.stretch;
    if (stretch && !settings.stretch_of_tool && ((*stretch)[0] > 1.0 || (*stretch)[1] < 1.0))
      refuse("/sequence/stretch", shown(keys.at("stretch")), "two ascending numbers with 1 between them");
  }

  /// Steps that reach tilts of a few degrees an iteration, measured.
  static SequenceFacts facts(const Settings& settings) {
    return {.move_limits = {0.03, 0.003, 0.003}, .characteristic_length = settings.characteristic_length};
  }

  static void follow_tool(Settings& settings, const ToolRange& tool) {
    settings.max_tilt =
        settings.given_max_tilt.value_or(tool.max_tilt < 90.0 ? tool.max_tilt : GuidedSettings::default_tilt);
    if (settings.stretch_of_tool) settings.stretch = tool.thickness;
  }

  template <int Dim>
  static void fix_lengths(Settings& settings, const Part<Dim>& part, double height_of_layers) {
    if (!settings.filter_radius) settings.filter_radius = 2.0 * part.grid().largest_spacing();
    if (settings.characteristic_length) return;
    settings.characteristic_length =
        height_of_layers > 0.0 ? height_of_layers : geodesic_height(part, geodesic_distance(part));
  }

  template <int Dim>
  static SequencePlaces<Dim> places(const Settings& settings, const Part<Dim>& part) {
    require_start_within_tilt<Dim>(part.plate(), settings);
    return {DesignSupport<Dim>(part.grid(), false, part.elements(), settings.components(Dim))};
  }

  template <int Dim>
  static std::unique_ptr<Sequence<Dim>> make(const Settings& settings, const SequenceContext<Dim>& context) {
    auto problem = std::make_unique<GuidedProblem<Dim>>(
        context.part, settings.void_diffusivity, context.make_heat_solver, context.across, context.lanes);
    return std::make_unique<GuidedSequence<Dim>>(context.part, settings, std::move(problem));
  }

 private:
  static void read_stretch(Settings& settings, const Json& value, const KeyPlace&) {
    settings.stretch_of_tool = value == "auto";
    if (value.is_array()) settings.stretch = value.get<std::array<double, 2>>();
  }
  static void read_start(Settings& settings, const Json& value, const KeyPlace&) {
    settings.start = value == "distance" ? GuidedStart::distance : GuidedStart::planar;
    if (!value.is_array()) return;
    settings.start = GuidedStart::direction;
    settings.direction = value.get<std::vector<double>>();
  }
};

const RegisteredSequence<GuidedKind> registered({.name = "guided",
                                                 .position = 2,
                                                 .has_design = true,
                                                 .with_gradient = "guided",
                                                 .move_limits = "0.03 for tilts (guided)",
                                                 .last_move_limits = "0.003 for tilts"});

}  // namespace

}  // namespace fabseq
