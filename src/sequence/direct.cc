// SPDX-License-Identifier: MIT
/// Sequences of type "direct" (docs/formulation.md 2.3).
#include "fabseq/part/part_settings.h"
#include "fabseq/sequence/sequence_kind.h"
#include "sequence/direct_sequence.h"

namespace fabseq {

namespace {

struct DirectKind {
  using Settings = DirectSettings;

  static Section<Settings> keys() {
    using Its = Settings;
    return Section<Its>("sequence")
        .key("location", &Its::location, "Where the pseudo-time varies; terms of thickness need nodes",
             {.words = "elements nodes"})
        .key("start", "Where the pseudo-time is 0; plate: all that touches plate or substrate",
             {.type = KeyType::shape, .default_value = to_text("plate"), .words = "plate"},
             [](Its& sequence, const Json& value, const KeyPlace& place) {
               if (value.is_object()) sequence.start = make_shape(value, place);
             })
        .key("filter_radius", &Its::filter_radius,
             "Radius within which times are smoothed inside the part; 0: none",
             {.range = "[0, inf)", .unit = "length"});
  }

  /// Move limit: measured for times.
  static SequenceFacts facts(const Settings& settings) {
    const bool on_nodes = settings.location == DesignLocation::nodes;
    return {.move_limits = {0.02, std::nullopt},
            .gradient_obstacle = on_nodes ? "" : "type \"direct\" and location \"elements\""};
  }

  template <int Dim>
  static SequencePlaces<Dim> places(const Settings& settings, const Part<Dim>& part) {
    StartRegion start = make_start_region(part, settings.location, settings.start);
    DesignSupport<Dim> support(part.grid(), settings.location == DesignLocation::nodes, start.free);
    return {std::move(support), std::move(start)};
  }

  template <int Dim>
  static std::unique_ptr<Sequence<Dim>> make(const Settings& settings, const SequenceContext<Dim>& context) {
    return make_direct_sequence(context.part, context.support, *context.start, settings.filter_radius);
  }
};

const RegisteredSequence<DirectKind> registered({.name = "direct",
                                                 .position = 2,
                                                 .has_design = true,
                                                 .with_gradient = "direct with location nodes",
                                                 .move_limits = "0.02 for times (direct)"});

}  // namespace

}  // namespace fabseq
