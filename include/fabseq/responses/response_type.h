// SPDX-License-Identifier: MIT
/// \file
/// The registry of responses: each registers itself from its own source, with its keys and what it needs.
#pragma once

#include "fabseq/keys/section.h"
#include "fabseq/layers/layer_settings.h"
#include "fabseq/responses/response.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

enum class TermList { objective, constraints };
enum class LayerKind { any, curved, multi_planar };

/// What the keys of a term are checked against.
struct TermPlace {
  std::string pointer;  ///< of the term, such as "/objective/0"
  int dimension;
  std::vector<std::string> node_sets;  ///< their names
  const LayerSettings& layers;
};

/// What is known of a response before there is a part: how it is called and what it needs.
struct ResponseTraits {
  TermList list = TermList::objective;
  std::string name;                          ///< the config's "type"
  LayerKind layers = LayerKind::any;         ///< that it is defined for
  bool needs_time_gradient = false;          ///< |grad t| and with it thickness
  TermScaling scaling = TermScaling::first;  ///< default of an objective term
  std::string weight_option = "";            ///< flat option of an objective term's weight
};

/// A type of term. Nothing here is collective but make().
class ResponseType : public ResponseTraits {
 public:
  explicit ResponseType(ResponseTraits traits) : ResponseTraits(std::move(traits)) {}
  ResponseType(const ResponseType&) = delete;
  ResponseType& operator=(const ResponseType&) = delete;
  virtual ~ResponseType() = default;

  /// Declarations of the keys of its own.
  virtual std::vector<ConfigKey> keys() const = 0;
  /// Relations of the term's keys to each other and to the rest of the config. Throws InputError.
  virtual void check(const Term& term, const TermPlace& place) const = 0;
  /// Whether the term measures after the release from plate or clamps.
  virtual bool measures_release(const Term& term) const = 0;
  /// How thick the term wants layers to be, length unit.
  virtual std::optional<double> target_thickness(const Term& term) const = 0;
  virtual std::unique_ptr<Response<2>> make(const Term& term, const ResponseContext<2>& context) const = 0;
  virtual std::unique_ptr<Response<3>> make(const Term& term, const ResponseContext<3>& context) const = 0;
};

/// The types of a list, by name.
std::vector<const ResponseType*> response_types(TermList list);
/// The type of that list with that name, nullptr where there is none.
const ResponseType* find_response_type(TermList list, const std::string& name);
/// Declarations of a list's terms, section "objective" or "constraints".
SectionKeys term_keys(TermList list);
/// A completed object of a list.
Term make_term(TermList list, const Json& object);
/// Called by Registered. Types are never taken out.
void register_type(const ResponseType* type);

/// Registers a response: one object of this type, in the response's source.
///   - Kind<Dim>: the response, with a constructor (const ResponseContext<Dim>&, const Settings&) or a static
///     function make() with these arguments;
///   - Settings: what its keys are bound to. If it has functions check(const TermPlace&),
///     measures_release() or target_thickness(), these are the type's.
template <template <int> class Kind, class Settings>
class Registered : public ResponseType {
 public:
  Registered(ResponseTraits traits, Section<Settings> keys)
      : ResponseType(std::move(traits)), keys_(std::move(keys)) {
    register_type(this);
  }

  std::vector<ConfigKey> keys() const override { return keys_.declarations().front().keys; }
  void check(const Term& term, const TermPlace& place) const override {
    if constexpr (requires(const Settings& settings) { settings.check(place); }) read(term).check(place);
  }
  bool measures_release(const Term& term) const override {
    if constexpr (requires(const Settings& settings) { settings.measures_release(); })
      return read(term).measures_release();
    return false;
  }
  std::optional<double> target_thickness(const Term& term) const override {
    if constexpr (requires(const Settings& settings) { settings.target_thickness(); })
      return read(term).target_thickness();
    return std::nullopt;
  }
  std::unique_ptr<Response<2>> make(const Term& term, const ResponseContext<2>& context) const override {
    return make_kind<2>(term, context);
  }
  std::unique_ptr<Response<3>> make(const Term& term, const ResponseContext<3>& context) const override {
    return make_kind<3>(term, context);
  }

 private:
  Settings read(const Term& term) const {
    Settings settings;
    keys_.read(settings, term.keys, {"", 0});
    return settings;
  }
  template <int Dim>
  std::unique_ptr<Response<Dim>> make_kind(const Term& term, const ResponseContext<Dim>& context) const {
    if constexpr (requires(const Settings& settings) { Kind<Dim>::make(context, settings); })
      return Kind<Dim>::make(context, read(term));
    else
      return std::make_unique<Kind<Dim>>(context, read(term));
  }

  Section<Settings> keys_;
};

}  // namespace fabseq
