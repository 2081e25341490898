// SPDX-License-Identifier: MIT
/// \file
/// The registry of responses. Each response registers itself in its own source, with its keys and what it
/// needs.
#pragma once

#include "fabseq/keys/section.h"
#include "fabseq/layers/layer_settings.h"
#include "fabseq/responses/response.h"

#include <any>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// The two lists of terms in a config.
enum class TermList { objective, constraints };
/// Kinds of layers that a response may need.
enum class LayerKind { any, curved, multi_planar };

/// The layers.type of a kind; empty for any.
std::string name_of(LayerKind kind);

/// What the keys of a term are checked against.
struct TermPlace {
  std::string pointer;  ///< JSON pointer of the term, such as "/objective/0"
  int dimension;
  std::vector<std::string> node_sets;  ///< names of all node sets
  const LayerSettings& layers;
  std::size_t scenarios;  ///< number of scenarios of the strain
  const ToolSettings& tool;
  const std::optional<ThermalSettings>& thermal;
  std::optional<BuildClock> clock;  ///< none: the time of the build is not known
};

/// ResponseTraits::unit of values that are shares of the part; people read them in percent.
inline constexpr const char* share_of_part = "share of the part";

/// What is known of a response before there is a part: its name and what it needs.
struct ResponseTraits {
  TermList list = TermList::objective;
  std::string name;                   ///< the config's "type"
  LayerKind layers = LayerKind::any;  ///< kind of layers that it is defined for
  bool needs_time_gradient = false;   ///< it needs |grad t|, as thickness does
  bool needs_torch_axis = false;      ///< it needs the torch's axis: grad t, unless tool.axis says otherwise
  TermScaling scaling = TermScaling::first;  ///< default scaling of an objective term
  double weight = 1.0;                       ///< its default weight
  std::string weight_option = "";  ///< flat option for the weight of an objective term; "" if there is none
  std::string unit = "";           ///< of a constraint's values, in words; "" without one
  std::string exact_check = "";    ///< check of binary layers (formulation 13.1), of which a constraint is a
                                   ///< smooth count: its name in `checks` of summary.json; "" without one
};

/// What is known of a term before there is a part.
struct TermFacts {
  bool measures_release = false;  ///< it measures displacements after the release from plate or clamps
  bool is_largest = false;    ///< the optimizer gets it as the largest of several (Response::largest_of())
  bool is_quadratic = false;  ///< it is a quadratic form of the displacement alone, and of nothing else
  bool asks_for_squares = false;  ///< the config asks to hand it to the optimizer as a sum of squares
  bool offers_squares = false;    ///< it may be handed over so unasked, with scaling current
  std::vector<std::string> node_sets = {};                ///< names of those that it measures
  std::optional<double> target_thickness = std::nullopt;  ///< of real layers, that it aims at, length unit
};

/// A type of term. Nothing here but make() is collective; make() is so on the grid's communicator.
class ResponseType : public ResponseTraits {
 public:
  explicit ResponseType(ResponseTraits traits) : ResponseTraits(std::move(traits)) {}
  ResponseType(const ResponseType&) = delete;
  ResponseType& operator=(const ResponseType&) = delete;
  virtual ~ResponseType() = default;

  /// Declarations of the type's own keys.
  virtual std::vector<ConfigKey> keys() const = 0;
  /// The settings, Term::own, that a completed config object describes.
  virtual std::any read(const Json& object) const = 0;
  /// The settings with the keys' defaults.
  virtual std::any defaults() const = 0;
  /// The term with another aggregate over the scenarios of the strain; none for types that have none.
  virtual std::optional<Term> aggregated(const Term& term, Aggregate aggregate) const = 0;
  /// Checks relations of the term's keys to each other and to the rest of the config. Throws InputError.
  virtual void check(const Term& term, const TermPlace& place) const = 0;
  virtual TermFacts facts(const Term& term) const = 0;
  virtual std::unique_ptr<Response<2>> make(const Term& term, const ResponseContext<2>& context) const = 0;
  virtual std::unique_ptr<Response<3>> make(const Term& term, const ResponseContext<3>& context) const = 0;
};

/// All types of a list, sorted by name. They live as long as the program.
std::vector<const ResponseType*> response_types(TermList list);
/// The type of a list with that name; nullptr if there is none.
const ResponseType* find_response_type(TermList list, const std::string& name);
/// Whether one of the terms measures displacements after the release.
bool any_measures_release(const std::vector<Term>& terms);
/// Declarations of the keys of a list's terms, section "objective" or "constraints".
SectionKeys term_keys(TermList list);
/// The term that a completed config object of a list describes.
Term make_term(TermList list, const Json& object);
/// Adds a type, which must live as long as the program; types are never removed. Registered calls it.
void register_type(const ResponseType* type);

/// Registers a response. The response's source defines one object of this type.
///   - Kind<Dim>: the response, with a constructor (const ResponseContext<Dim>&, const Settings&) or a static
///     function make() with these arguments;
///   - Settings: what its keys are bound to. If it has functions check(const TermPlace&) or facts(), these
///     are the type's.
template <template <int> class Kind, class Settings>
class Registered : public ResponseType {
 public:
  Registered(ResponseTraits traits, Section<Settings> keys)
      : ResponseType(std::move(traits)), keys_(std::move(keys)) {
    register_type(this);
  }

  std::vector<ConfigKey> keys() const override { return keys_.declarations().front().keys; }
  std::any read(const Json& object) const override {
    Settings settings;
    keys_.read(settings, object, {"", 0});
    return settings;
  }
  std::any defaults() const override { return Settings{}; }
  std::optional<Term> aggregated(const Term& term, Aggregate aggregate) const override {
    if constexpr (requires(Settings & settings) { settings.aggregate = aggregate; }) {
      Settings settings = own(term);
      settings.aggregate = aggregate;
      Term result = term;
      result.own = settings;
      return result;
    }
    return std::nullopt;
  }
  void check(const Term& term, const TermPlace& place) const override {
    if constexpr (requires(const Settings& settings) { settings.check(place); }) own(term).check(place);
  }
  TermFacts facts(const Term& term) const override {
    if constexpr (requires(const Settings& settings) { settings.facts(); }) return own(term).facts();
    return {};
  }
  std::unique_ptr<Response<2>> make(const Term& term, const ResponseContext<2>& context) const override {
    return make_kind<2>(term, context);
  }
  std::unique_ptr<Response<3>> make(const Term& term, const ResponseContext<3>& context) const override {
    return make_kind<3>(term, context);
  }

 private:
  static const Settings& own(const Term& term) { return std::any_cast<const Settings&>(term.own); }
  template <int Dim>
  std::unique_ptr<Response<Dim>> make_kind(const Term& term, const ResponseContext<Dim>& context) const {
    if constexpr (requires(const Settings& settings) { Kind<Dim>::make(context, settings); })
      return Kind<Dim>::make(context, own(term));
    else
      return std::make_unique<Kind<Dim>>(context, own(term));
  }

  Section<Settings> keys_;
};

}  // namespace fabseq
