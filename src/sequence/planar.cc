// SPDX-License-Identifier: MIT
/// Sequences of type "planar" (docs/formulation.md 3.3).
#include "fabseq/keys/direction.h"
#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/sequence_kind.h"

namespace fabseq {

namespace {

struct PlanarKind {
  using Settings = PlanarSettings;

  static Section<Settings> keys() {
    return Section<Settings>("sequence")
        .key("direction", &Settings::direction, "Build direction; auto: the plate's normal",
             {.words = "auto"});
  }

  static void check(const Settings& settings, const Json& keys) {
    check_direction("/sequence/direction", keys.at("direction"), settings.direction, {"auto"});
  }

  static SequenceFacts facts(const Settings& /*settings*/) { return {}; }

  template <int Dim>
  static std::unique_ptr<Sequence<Dim>> make(const Settings& settings, const SequenceContext<Dim>& context) {
    return std::make_unique<GivenSequence<Dim>>(planar_time(context.part, settings.direction));
  }
};

const RegisteredSequence<PlanarKind> registered(
    {.name = "planar", .position = 3, .binary = true, .with_gradient = "planar"});

}  // namespace

}  // namespace fabseq
