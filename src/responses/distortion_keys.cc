// SPDX-License-Identifier: MIT
/// The keys of distortion terms, and what they allow of each other.
#include "fabseq/base/error.h"
#include "responses/distortion.h"

#include <algorithm>

namespace fabseq {

namespace {

constexpr const char* measure_names = "displacement flatness layerwise shape angle";
constexpr const char* aggregate_names = "nominal mean spread worst";

void check_node_set(const TermPlace& place, const char* key, const std::string& name) {
  const std::string pointer = pointer_to(place.pointer, key);
  const std::vector<std::string>& known = place.node_sets;
  const std::string list = known.empty() ? "none, as node_sets is empty" : join(known, ", ");
  if (name.empty()) throw InputError(pointer + ": missing; allowed: name of a node set (" + list + ")");
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  const std::string nearest = nearest_word(name, known);
  const std::string hint = nearest.empty() ? "" : ", did you mean \"" + nearest + "\"?";
  refuse(pointer, "unknown node set " + shown(name) + hint, list);
}

}  // namespace

TermFacts DistortionSettings::facts() const {
  const bool of_displacement = measure != Measure::layerwise && measure != Measure::angle;
  const bool is_square = of_displacement && !norm && aggregate == Aggregate::nominal;
  TermFacts result{.measures_release = after_release,
                   .is_largest = aggregate == Aggregate::worst,
                   .is_quadratic = is_square && !after_release,
                   .asks_for_squares = least_squares.value_or(false),
                   .offers_squares = is_square && !least_squares};
  for (const std::string& name : {nodes, to})
    if (!name.empty()) result.node_sets.push_back(name);
  return result;
}

bool DistortionSettings::fits(const std::string& motion) const {
  return std::find(fit.begin(), fit.end(), motion) != fit.end();
}

std::string DistortionSettings::with_measure() const {
  return " with measure " + split(measure_names, ' ')[static_cast<std::size_t>(measure)];
}

std::string DistortionSettings::aggregate_name() const {
  return split(aggregate_names, ' ')[static_cast<std::size_t>(aggregate)];
}

void DistortionSettings::check_node_sets(const TermPlace& place) const {
  const std::string pointer = pointer_to(place.pointer, "to");
  check_node_set(place, "nodes", nodes);
  if (measure == Measure::angle) {
    check_node_set(place, "to", to);
    if (to == nodes) refuse(pointer, shown(to) + ", the node set of nodes", "name of another node set");
  } else if (!to.empty()) {
    refuse(pointer, shown(to) + with_measure(), "only with measure angle");
  }
}

void DistortionSettings::check(const TermPlace& place) const {
  const auto at = [&](const char* key) { return pointer_to(place.pointer, key); };
  const bool layerwise = measure == Measure::layerwise;
  if (!layerwise) check_node_sets(place);
  for (const auto& [key, name] : {std::pair("nodes", nodes), std::pair("to", to)})
    if (layerwise && !name.empty())
      refuse(at(key), shown(name), "no node set with measure layerwise, which takes all nodes");
  if (measure == Measure::flatness && axis < 0)
    throw InputError(at("axis") + ": missing; allowed: " + (place.dimension == 2 ? "x, y" : "x, y, z"));
  if (measure != Measure::flatness && axis >= 0)
    refuse(at("axis"), shown(std::string(1, static_cast<char>('x' + axis))), "only with measure flatness");
  if (mean && measure != Measure::displacement)
    refuse(at("mean"), "true" + with_measure(), "true only with measure displacement");
  if (norm && measure != Measure::displacement)
    refuse(at("norm"), shown(*norm) + with_measure(), "only with measure displacement");
  if (norm && mean) refuse(at("mean"), "true with a norm", "false with a norm, which is a mean");
  if (layerwise && after_release)
    refuse(at("after_release"), "true" + with_measure(),
           "true only with measures displacement, flatness, shape and angle");
  if ((layerwise || measure == Measure::angle) && least_squares.value_or(false))
    refuse(at("least_squares"), "true" + with_measure(),
           "true only with measures displacement, flatness and shape; \"auto\" or false");
  if (norm && least_squares.value_or(false))
    refuse(at("least_squares"), "true with a norm", "\"auto\" or false with a norm");
  if (aggregate != Aggregate::nominal && least_squares.value_or(false))
    refuse(at("least_squares"), "true with aggregate " + aggregate_name(),
           "\"auto\" or false, or aggregate nominal");
  if (aggregate != Aggregate::nominal && place.scenarios == 0)
    refuse(at("aggregate"), shown(aggregate_name()) + " without material.scenarios",
           "nominal, or any with a list of scenarios");
  if (!fits("translation"))
    refuse(at("fit"), shown(fit), "a list with \"translation\", and with \"rotation\" and \"scale\" or not");
}

Section<DistortionSettings> distortion_keys(const std::string& section) {
  using Its = DistortionSettings;
  return Section<Its>(section)
      .key("measure", &Its::measure, "Which square is measured", {.words = measure_names})
      .key("nodes", &Its::nodes, "Node set of all measures but layerwise")
      .key("to", &Its::to, "Second node set of angle")
      .key("axis", &Its::axis, "Axis of flatness", {.type = KeyType::axis})
      .key("fit", "Motions of the best fit of shape; translation always",
           {.type = KeyType::word_list,
            .default_value = to_text(Its{}.fit),
            .words = "translation rotation scale"},
           [](Its& settings, const Json& value, const KeyPlace&) { value.get_to(settings.fit); })
      .key("mean", &Its::mean, "Mean square instead of the sum of displacement")
      .key("norm", &Its::norm,
           "Power p of displacement, ((1/n) sum of |u|^p)^(2/p); 8: near the largest square",
           {.range = "[2, inf)"})
      .key("aggregate", &Its::aggregate,
           "Of material.scenarios: the given strain, mean, spread or worst counts",
           {.words = aggregate_names})
      .key("after_release", &Its::after_release, "Measure after the release from plate or clamps");
}

}  // namespace fabseq
