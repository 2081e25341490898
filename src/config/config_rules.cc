// SPDX-License-Identifier: MIT
/// Relations between keys of different sections.
#include "fabseq/config/config.h"
#include "fabseq/keys/config_key.h"
#include "fabseq/keys/direction.h"
#include "fabseq/process/process_rules.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/sequence/sequence_kind.h"

#include <algorithm>
#include <cctype>
#include <cmath>

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
  check_magnitude("/projection/beta", config.projection.beta.value_or(0.0));
  check_magnitude("/projection/max", config.projection.max.value_or(0.0));
  for (const Term& term : config.objective) {
    const std::string pointer = pointer_to("/objective", term.position);
    check_magnitude(pointer_to(pointer, "weight"), term.weight);
    check_magnitude(pointer_to(pointer, "normalize"), term.normalize);
  }
  for (const double strain : config.material.inherent_strain)
    check_magnitude("/material/inherent_strain", strain);
  if (const auto& strain = config.material.turning_strain) {
    check_magnitude("/material/inherent_strain/tangential", strain->tangential);
    check_magnitude("/material/inherent_strain/normal", strain->normal);
  }
}

/// Message text for configs without a gradient of the pseudo-time, which thickness and turning strains need
/// and which element-wise values do not have.
std::string without_gradient(const Config& config) {
  return " with sequence " + config.sequence.facts.gradient_obstacle +
         ", for which the gradient of the pseudo-time is not defined";
}

void check_strain(const Config& config) {
  if (!config.material.turning_strain || config.has_time_gradient() || config.layers.multi_planar) return;
  refuse("/material/inherent_strain", given(config, "material", "inherent_strain") + without_gradient(config),
         "a list of numbers, or sequence type " + sequences_with_gradient());
}

/// A simulated layer stands for one number of real ones.
void check_passes(const Config& config) {
  const int passes = config.layers.passes;
  if (!config.thermal || passes == 1 || config.thermal->passes == passes) return;
  refuse("/thermal/passes", given(config, "thermal", "passes") + " with layers.passes " + shown(passes),
         "\"layers\" or the same number");
}

/// Each rank gathers the layers of all elements.
void check_torch(const Config& config) {
  if (config.tool.profile.empty()) return;
  constexpr double most_elements = 1e8;
  double elements = 1.0;
  for (const int count : config.elements) elements *= count;
  if (elements > most_elements)
    refuse("/tool/profile", "a torch with " + shown(elements) + " elements", "[] above 1e8 elements");
}

/// Checks what a term needs: a kind of layers, and the gradient of the pseudo-time.
void check_region(const Config& config) {
  if (config.solver.region != SolverRegion::built || may_leave_out_unbuilt(config.process)) return;
  const bool is_quiet = config.process.void_model == VoidModel::quiet;
  refuse("/solver/region",
         std::string("\"built\" with process.") + (is_quiet ? "void \"quiet\"" : "deposition \"follow\""),
         "\"whole\"");
}

void check_needs(const Config& config, const ResponseType& type, const std::string& pointer) {
  if (!config.has_layers_of(type))
    refuse(pointer, shown(type.name) + " with layers of type " + given(config, "layers", "type"),
           "this type with layers of type " + name_of(type.layers));
  if (config.needs_time_gradient(type) && !config.has_time_gradient())
    refuse(pointer, shown(type.name) + without_gradient(config),
           "this type with sequence type " + sequences_with_gradient());
}

void check_terms(const Config& config, const std::vector<Term>& terms, const std::string& list) {
  TermPlace place{"",
                  config.dimension(),
                  {},
                  config.layers,
                  config.material.scenarios.size(),
                  config.tool,
                  config.thermal,
                  config.clock()};
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
  for (const Term& term : terms)
    if (term.type->facts(term).asks_for_squares)
      refuse(pointer(term, "least_squares"), "true beside a term with aggregate worst", "\"auto\" or false");
}

std::vector<std::string> sequences_with_design() {
  std::vector<std::string> result;
  for (const SequenceKind* kind : sequence_kinds())
    if (kind->has_design) result.push_back(kind->name);
  return result;
}

void check_optimizer(const Config& config) {
  const OptimizerSettings& optimizer = config.optimizer;
  for (std::size_t start = 0; start < optimizer.starts.size(); ++start)
    (void)with_start(config, config.effective.at("sequence"), start);
  if (optimizer.final_move_limit <= optimizer.move_limit) return;
  refuse("/optimizer/final_move_limit", given(config, "optimizer", "final_move_limit"),
         "\"auto\" or a number in (0, " + shown(optimizer.move_limit) + "], at most move_limit");
}

}  // namespace

void check_rules(const Config& config) {
  check_names(config);
  check_magnitudes(config);
  config.sequence.kind->check(config.sequence, config.effective.at("sequence"));
  check_direction("/baseline/direction", config.effective.at("baseline").at("direction"),
                  config.baseline.direction, {"auto", "best"});
  check_direction("/tool/axis", config.effective.at("tool").at("axis"), config.tool.axis, {"normal"});
  check_torch(config);
  check_strain(config);
  check_curves(config.material);
  if (config.thermal) check_thermal(*config.thermal, config.material, config.process);
  check_passes(config);
  check_terms(config, config.objective, "objective");
  check_terms(config, config.constraints, "constraints");
  check_largest(config);
  check_layers(config.layers, config.projection, config.effective, config.dimension());
  check_optimizer(config);
  check_region(config);
  check_process(config.material, config.process, config.thermal.has_value(), config.dimension());
}

void check_task(const Config& config, Task task) {
  if (task != Task::optimize && task != Task::check_gradients) return;
  const std::string with_task =
      std::string("with -task ") + (task == Task::optimize ? "optimize" : "check_gradients");
  if (!config.sequence.kind->has_design)
    refuse("/sequence/type", given(config, "sequence", "type") + ", which has nothing to vary",
           join(sequences_with_design(), ", ") + " " + with_task + ", all with -task simulate");
  if (config.projection.binary)
    refuse("/projection/binary", "true", "false " + with_task + ", which needs derivatives");
  if (task == Task::optimize && config.objective.empty())
    refuse("/objective", "[]", "at least one term " + with_task);
}

}  // namespace fabseq
