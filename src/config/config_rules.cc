// SPDX-License-Identifier: MIT
/// Relations between keys of different sections.
#include "fabseq/config/config.h"
#include "fabseq/keys/config_key.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>

namespace fabseq {

namespace {

/// Text of a value as the effective config has it.
std::string given(const Config& config, const char* section, const char* key) {
  return shown(config.effective.at(section).at(key));
}

/// Whether a name can be used: names of node sets appear in paths of -set, and that of the config appears in
/// file names.
bool is_plain_name(const std::string& name, const std::string& forbidden) {
  const auto bad = [&](unsigned char character) {
    return std::iscntrl(character) != 0 || forbidden.find(static_cast<char>(character)) != std::string::npos;
  };
  return !name.empty() && std::none_of(name.begin(), name.end(), bad);
}

void check_names(const Config& config) {
  if (!is_plain_name(config.name, "/") || config.name == "." || config.name == "..") {
    refuse("/name", shown(config.name), "a text without '/' and control characters, other than . and ..");
  }
  for (const auto& [name, description] : config.node_sets) {
    const std::string pointer = pointer_to("/node_sets", name);
    if (!is_plain_name(name, "/.")) {
      refuse(pointer, "the name " + shown(name), "names without '.', '/' and control characters, not empty");
    }
    if (description.samples == 1)
      refuse(pointer_to(pointer, "samples"), "1", "0 (all nodes) or an integer >= 2");
  }
}

/// Volumes and squares of lengths, stiffnesses and strains are computed: with values beyond these magnitudes
/// they would silently become 0 or infinite.
void check_magnitude(const std::string& pointer, double value) {
  constexpr double least = 1e-40, most = 1e40;
  if (value == 0.0 || (std::abs(value) >= least && std::abs(value) <= most)) return;
  refuse(pointer, shown(value), "0, or a magnitude from 1e-40 to 1e40");
}

void check_magnitudes(const Config& config) {
  for (std::size_t axis = 0; axis < config.size.size(); ++axis) {
    check_magnitude(pointer_to("/domain/size", axis), config.size[axis]);
    check_magnitude(pointer_to("/domain/size", axis), config.size[axis] / config.elements[axis]);
  }
  check_magnitude("/domain/thickness", config.thickness);
  check_magnitude("/material/young", config.material.young);
  for (const double strain : config.material.inherent_strain)
    check_magnitude("/material/inherent_strain", strain);
  if (const auto& strain = config.material.turning_strain) {
    check_magnitude("/material/inherent_strain/tangential", strain->tangential);
    check_magnitude("/material/inherent_strain/normal", strain->normal);
  }
}

/// `word`: what the key takes in place of a vector.
void check_direction(const Config& config, const char* section, const char* key, const char* word,
                     const std::vector<double>& direction) {
  const bool zero =
      std::all_of(direction.begin(), direction.end(), [](double value) { return value == 0.0; });
  if (direction.empty() || !zero) return;
  refuse(pointer_to(pointer_to("", std::string(section)), std::string(key)), given(config, section, key),
         std::string("\"") + word + "\" or a vector other than 0");
}

void check_initial_diffusivity(const Config& config) {
  const SequenceSettings& sequence = config.sequence;
  if (!sequence.initial) return;
  if (*sequence.initial >= sequence.min_diffusivity && *sequence.initial <= sequence.max_diffusivity) return;
  refuse("/sequence/initial", given(config, "sequence", "initial"),
         "\"distance\" or a number within bounds " + given(config, "sequence", "bounds"));
}

/// Message text for configs without a gradient of the pseudo-time, which thickness and turning strains need
/// and which element-wise values do not have.
std::string without_gradient(const Config& config) {
  const bool file = config.sequence.type == SequenceType::file;
  return std::string(" with sequence type ") + (file ? "\"file\"" : "\"direct\" and location \"elements\"") +
         ", for which the gradient of the pseudo-time is not defined";
}

void check_strain(const Config& config) {
  if (!config.material.turning_strain || config.has_time_gradient() || config.layers.multi_planar) return;
  refuse("/material/inherent_strain", given(config, "material", "inherent_strain") + without_gradient(config),
         "a list of numbers, or sequence type heat, planar, or direct with location nodes");
}

/// The torch turns with the layers, and each rank gathers the layers of all elements.
void check_torch(const Config& config) {
  if (config.tool.profile.empty()) return;
  if (config.tool.axis.empty() && !config.has_time_gradient() && !config.layers.multi_planar)
    refuse("/tool/axis", "\"normal\"" + without_gradient(config), "a vector, such as the plate's normal");
  constexpr double most_elements = 1e8;
  double elements = 1.0;
  for (const int count : config.elements) elements *= count;
  if (elements > most_elements)
    refuse("/tool/profile", "a torch with " + shown(elements) + " elements", "[] above 1e8 elements");
}

/// Checks what a term needs: a kind of layers, and the gradient of the pseudo-time.
void check_needs(const Config& config, const ResponseType& type, const std::string& pointer) {
  const LayerKind kind = config.layers.multi_planar ? LayerKind::multi_planar : LayerKind::curved;
  const auto name = [](LayerKind of) { return of == LayerKind::curved ? "curved" : "multi_planar"; };
  if (type.layers != LayerKind::any && type.layers != kind)
    refuse(pointer, shown(type.name) + " with layers of type \"" + name(kind) + "\"",
           std::string("this type with layers of type ") + name(type.layers));
  if (type.needs_time_gradient && !config.has_time_gradient())
    refuse(pointer, shown(type.name) + without_gradient(config),
           "this type with sequence type heat, planar, or direct with location nodes");
}

void check_terms(const Config& config, const std::vector<Term>& terms, const std::string& list) {
  TermPlace place{"", config.dimension(), {}, config.layers, config.material.scenarios.size(), config.tool};
  for (const auto& member : config.node_sets) place.node_sets.push_back(member.first);
  for (std::size_t i = 0; i < terms.size(); ++i) {
    place.pointer = pointer_to(pointer_to("", list), i);
    check_needs(config, *terms[i].type, pointer_to(place.pointer, "type"));
    terms[i].type->check(terms[i], place);
  }
}

/// The optimizer has one z: a single objective term may be the largest of several values, and residuals of
/// least squares beside it would compete with it.
void check_largest(const Config& config) {
  const std::vector<Term>& terms = config.objective;
  const auto is_largest = [](const Term& term) { return term.type->facts(term).is_largest; };
  const auto first = std::find_if(terms.begin(), terms.end(), is_largest);
  if (first == terms.end()) return;
  const auto pointer = [&](const Term& term, const char* key) {
    return pointer_to(pointer_to("/objective", static_cast<std::size_t>(&term - terms.data())), key);
  };
  const auto second = std::find_if(first + 1, terms.end(), is_largest);
  if (second != terms.end())
    refuse(pointer(*second, "aggregate"), "\"worst\" a second time", "one objective term with it");
  for (const Term& term : terms) {
    const Json* least_squares = find_member(term.keys, "least_squares");
    if (least_squares != nullptr && *least_squares == true)
      refuse(pointer(term, "least_squares"), "true beside a term with aggregate worst", "\"auto\" or false");
  }
}

void check_angles(const Config& config) {
  const MultiPlanarSettings& layers = *config.layers.multi_planar;
  const auto angles = static_cast<std::size_t>(config.dimension()) - 1,
             subparts = static_cast<std::size_t>(layers.subparts);
  const std::string of_subparts = " for " + std::to_string(subparts) + " sub-parts";
  const Json& directions = config.effective.at("layers").at("angles");
  if (directions.is_array() && directions.size() != subparts)
    refuse("/layers/angles", given(config, "layers", "angles") + of_subparts,
           "a list of angles for each of them");
  const Json& bounds = config.effective.at("layers").at("angle_bounds");
  const std::size_t pairs = bounds[0].is_number() ? 1 : bounds.size();
  if (pairs != 1 && pairs != angles && pairs != subparts * angles)
    refuse("/layers/angle_bounds", std::to_string(pairs) + " pairs",
           "one pair, " + std::to_string(angles) + " or " + std::to_string(subparts * angles));
  for (std::size_t i = 0; i < layers.angles.size(); ++i)
    if (layers.angles[i] < layers.lowest_angles[i] || layers.angles[i] > layers.highest_angles[i])
      refuse("/layers/angles/" + std::to_string(i / angles) + "/" + std::to_string(i % angles),
             shown(layers.angles[i]),
             "a number within its bounds, " + shown(layers.lowest_angles[i]) + " to " +
                 shown(layers.highest_angles[i]));
}

void check_multi_planar(const Config& config) {
  const MultiPlanarSettings& layers = *config.layers.multi_planar;
  const std::vector<double>& timestamps = layers.timestamps;
  const Json& times = config.effective.at("layers").at("timestamps");
  if ((times.is_array() && times.size() + 1 != static_cast<std::size_t>(layers.subparts)) ||
      !std::is_sorted(timestamps.begin(), timestamps.end(), std::less_equal<>()))
    refuse("/layers/timestamps", given(config, "layers", "timestamps"),
           "\"auto\" or " + std::to_string(layers.subparts - 1) +
               " ascending numbers in (0, 1), one less than subparts");
  check_angles(config);
  if (layers.fixed_angles && layers.fixed_time)
    refuse("/layers/fixed", given(config, "layers", "fixed"), "[], [\"angles\"] or [\"time\"]");
  for (const char* key : {"beta", "max"})
    if (config.effective.at("projection").at(key).is_number())
      refuse(pointer_to("/projection", std::string(key)), given(config, "projection", key),
             "\"auto\" with layers of type multi_planar, whose sharpness is layers.sharpness");
}

void check_layers(const Config& config) {
  if (config.layers.multi_planar) return check_multi_planar(config);
  if (config.layers.count || config.layers.target) return;
  refuse("/layers/count", "\"auto\" without a layer_thickness constraint",
         "an integer in [1, " + std::to_string(most_layers) +
             "], or \"auto\" with a constraint of type layer_thickness");
}

void check_projection(const Config& config) {
  const ProjectionSettings& projection = config.projection;
  std::optional<double> start = projection.beta;
  if (!start && config.layers.count) start = 4.0 * *config.layers.count;
  if (!start || !projection.max || *projection.max >= *start) return;
  const char* origin = projection.beta ? " (beta)" : " (beta, 4 times the number of layers)";
  refuse("/projection/max", given(config, "projection", "max"),
         "\"auto\" or a number >= " + shown(*start) + origin);
}

void check_optimizer(const Config& config) {
  const OptimizerSettings& optimizer = config.optimizer;
  if (optimizer.final_move_limit <= optimizer.move_limit) return;
  refuse("/optimizer/final_move_limit", given(config, "optimizer", "final_move_limit"),
         "\"auto\" or a number in (0, " + shown(optimizer.move_limit) + "], at most move_limit");
}

}  // namespace

void check_rules(const Config& config) {
  check_names(config);
  check_magnitudes(config);
  check_direction(config, "sequence", "direction", "auto", config.sequence.direction);
  check_direction(config, "baseline", "direction", "auto", config.baseline.direction);
  check_direction(config, "tool", "axis", "normal", config.tool.axis);
  check_torch(config);
  check_initial_diffusivity(config);
  check_strain(config);
  check_terms(config, config.objective, "objective");
  check_terms(config, config.constraints, "constraints");
  check_largest(config);
  check_layers(config);
  check_projection(config);
  check_optimizer(config);
}

void check_task(const Config& config, Task task) {
  if (task != Task::optimize && task != Task::check_gradients) return;
  const std::string with_task =
      std::string("with -task ") + (task == Task::optimize ? "optimize" : "check_gradients");
  if (config.sequence.type != SequenceType::heat && config.sequence.type != SequenceType::direct) {
    refuse("/sequence/type", given(config, "sequence", "type") + ", which has nothing to vary",
           "heat, direct " + with_task + ", all with -task simulate");
  }
  if (config.projection.binary)
    refuse("/projection/binary", "true", "false " + with_task + ", which needs derivatives");
  if (task == Task::optimize && config.objective.empty())
    refuse("/objective", "[]", "at least one term " + with_task);
}

}  // namespace fabseq
