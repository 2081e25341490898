// SPDX-License-Identifier: MIT
/// \file
/// The registry of sequences. Each kind registers itself in its own source, with its keys, its rules and what
/// others ask about it.
#pragma once

#include "fabseq/grid/unknown_numbering.h"
#include "fabseq/keys/section.h"
#include "fabseq/part/part.h"
#include "fabseq/sequence/design_support.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/sequence/sequence_settings.h"
#include "fabseq/sequence/start_region.h"
#include "fabseq/solve/heat_solver.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// What is known of a kind of sequence before its keys are read.
struct SequenceTraits {
  std::string name;         ///< the config's "type"
  int position = 0;         ///< in lists of kinds, which are sorted by it, then by name
  bool has_design = false;  ///< whether there is anything to optimize
  bool binary = false;      ///< its layers are steps, whatever "projection" says
  /// Values of "type" and, where it depends on them, other keys for which grad t is defined, as messages have
  /// them: `direct with location nodes`; empty: it never is.
  std::string with_gradient = "";
  std::string bounds_key = "";  ///< key that bounds the design; empty: the bounds are fixed
  /// Words for the meanings of the optimizer's keys: what the move limits are, and what they are at the end
  /// of a run where that is less.
  std::string move_limits = "", last_move_limits = "";
};

/// Where a sequence has design variables.
template <int Dim>
struct SequencePlaces {
  DesignSupport<Dim> support;
  std::optional<StartRegion> start = std::nullopt;  ///< of sequences that begin in a region
};

/// What a sequence is made of. All but the function must outlive it.
template <int Dim>
struct SequenceContext {
  const Part<Dim>& part;
  const DesignSupport<Dim>& support;  ///< SequencePlaces::support
  const std::optional<StartRegion>& start;
  double target_gradient;  ///< |grad t| of layers as thick as they shall be, 1/length; 0: no target thickness
  MPI_Comm across;         ///< this rank and its copies in other layer groups
  int lanes;               ///< most rows that are solved side by side
  /// Makes a heat solver on a domain, to which it may refer; `lumped`: whether the mass matrix is diagonal.
  std::function<std::unique_ptr<HeatSolver<Dim>>(const SystemDomain& domain, bool lumped)> make_heat_solver;
};

/// A kind of sequence. fix_lengths(), places() and make() are collective on the grid's communicator, nothing
/// else is.
class SequenceKind : public SequenceTraits {
 public:
  explicit SequenceKind(SequenceTraits traits) : SequenceTraits(std::move(traits)) {}
  SequenceKind(const SequenceKind&) = delete;
  SequenceKind& operator=(const SequenceKind&) = delete;
  virtual ~SequenceKind() = default;

  /// Declarations of the kind's own keys and of their subsections.
  virtual std::vector<SectionKeys> keys() const = 0;
  /// The settings that a completed config object describes.
  virtual SequenceSettings read(const Json& object, const KeyPlace& place) const = 0;
  /// Brings a completed config object to what the settings say.
  virtual void write(const SequenceSettings& settings, Json& object) const = 0;
  /// Fixes what "auto" stands for where it follows from the tool.
  virtual void follow_tool(SequenceSettings& settings, const ToolRange& tool) const = 0;
  /// Fixes the lengths that "auto" stands for. `height_of_layers`: number of layers times their target
  /// thickness; 0: no target. Collective on the grid's communicator.
  virtual void fix_lengths(SequenceSettings& settings, const Part<2>& part,
                           double height_of_layers) const = 0;
  virtual void fix_lengths(SequenceSettings& settings, const Part<3>& part,
                           double height_of_layers) const = 0;
  /// Checks relations between the kind's keys, whose values in the config messages show. Throws InputError.
  virtual void check(const SequenceSettings& settings, const Json& keys) const = 0;
  /// Throws InputError if the settings do not fit the part.
  virtual SequencePlaces<2> places(const SequenceSettings& settings, const Part<2>& part) const = 0;
  virtual SequencePlaces<3> places(const SequenceSettings& settings, const Part<3>& part) const = 0;
  virtual std::unique_ptr<Sequence<2>> make(const SequenceSettings& settings,
                                            const SequenceContext<2>& context) const = 0;
  virtual std::unique_ptr<Sequence<3>> make(const SequenceSettings& settings,
                                            const SequenceContext<3>& context) const = 0;
};

/// All kinds, in the order of their positions. They live as long as the program.
std::vector<const SequenceKind*> sequence_kinds();
/// What one of the traits says for each kind of which it says anything.
std::vector<std::string> of_sequence_kinds(std::string SequenceTraits::*trait);
/// The sequences for which grad t is defined, as a list for messages.
std::string sequences_with_gradient();
/// Declarations of section "sequence" and of its subsections.
std::vector<SectionKeys> sequence_keys();
/// The settings that a completed config object describes.
SequenceSettings read_sequence(const Json& object, const KeyPlace& place);
/// Adds a kind, which must live as long as the program; kinds are never removed. RegisteredSequence calls it.
void register_kind(const SequenceKind* kind);

/// Registers a kind of sequence. The kind's source defines one object of this type. `Kind` has
///   - a type Settings, which its keys are bound to;
///   - static Section<Settings> keys(), with the path "sequence";
///   - static SequenceFacts facts(const Settings&);
///   - static make(const Settings&, const SequenceContext<Dim>&), a template of Dim, which returns the
///     Sequence<Dim> as a std::unique_ptr;
///   - if it has a design: static places(const Settings&, const Part<Dim>&), a template of Dim, which returns
///     SequencePlaces<Dim>;
///   - if something follows from the tool: static void follow_tool(Settings&, const ToolRange&);
///   - if lengths follow from the part: static void fix_lengths(Settings&, const Part<Dim>&, double
///     height_of_layers), a template of Dim;
///   - if there are rules: static void check(const Settings&, const Json& keys) of a completed config object,
///     which throws InputError.
template <class Kind>
class RegisteredSequence : public SequenceKind {
 public:
  using Settings = typename Kind::Settings;

  explicit RegisteredSequence(SequenceTraits traits) : SequenceKind(std::move(traits)) {
    register_kind(this);
  }

  std::vector<SectionKeys> keys() const override { return Kind::keys().declarations(); }
  SequenceSettings read(const Json& object, const KeyPlace& place) const override {
    Settings own;
    Kind::keys().read(own, object, place);
    return {this, own, Kind::facts(own)};
  }
  void write(const SequenceSettings& settings, Json& object) const override {
    Settings own = settings.as<Settings>();
    Kind::keys().write(own, object);
  }
  void follow_tool(SequenceSettings& settings, const ToolRange& tool) const override {
    if constexpr (requires(Settings & own) { Kind::follow_tool(own, tool); }) {
      Settings own = settings.as<Settings>();
      Kind::follow_tool(own, tool);
      settings.own = own;
    }
  }
  void fix_lengths(SequenceSettings& settings, const Part<2>& part, double height_of_layers) const override {
    fix_lengths_of_kind(settings, part, height_of_layers);
  }
  void fix_lengths(SequenceSettings& settings, const Part<3>& part, double height_of_layers) const override {
    fix_lengths_of_kind(settings, part, height_of_layers);
  }
  void check(const SequenceSettings& settings, const Json& keys) const override {
    if constexpr (requires(const Settings& own) { Kind::check(own, keys); })
      Kind::check(settings.as<Settings>(), keys);
  }
  SequencePlaces<2> places(const SequenceSettings& settings, const Part<2>& part) const override {
    return places_of_kind<2>(settings, part);
  }
  SequencePlaces<3> places(const SequenceSettings& settings, const Part<3>& part) const override {
    return places_of_kind<3>(settings, part);
  }
  std::unique_ptr<Sequence<2>> make(const SequenceSettings& settings,
                                    const SequenceContext<2>& context) const override {
    return Kind::template make<2>(settings.as<Settings>(), context);
  }
  std::unique_ptr<Sequence<3>> make(const SequenceSettings& settings,
                                    const SequenceContext<3>& context) const override {
    return Kind::template make<3>(settings.as<Settings>(), context);
  }

 private:
  template <int Dim>
  static void fix_lengths_of_kind(SequenceSettings& settings, const Part<Dim>& part,
                                  double height_of_layers) {
    Settings own = settings.as<Settings>();
    if constexpr (requires { Kind::template fix_lengths<Dim>(own, part, height_of_layers); })
      Kind::template fix_lengths<Dim>(own, part, height_of_layers);
    settings.own = own;
    settings.facts = Kind::facts(own);
  }
  template <int Dim>
  static SequencePlaces<Dim> places_of_kind(const SequenceSettings& settings, const Part<Dim>& part) {
    if constexpr (requires(const Settings& own) { Kind::template places<Dim>(own, part); })
      return Kind::template places<Dim>(settings.as<Settings>(), part);
    else
      return {DesignSupport<Dim>(part.grid(), false, {})};
  }
};

}  // namespace fabseq
