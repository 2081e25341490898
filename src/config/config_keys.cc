// SPDX-License-Identifier: MIT
#include "config/config_keys.h"

#include "fabseq/machine/machine_entries.h"
#include "fabseq/part/part_settings.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/sequence/sequence_kind.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Binding of a section to a base class of Config.
template <class Base>
Base& base_of(Config& config) {
  return config;
}

ThermalSettings& thermal_of(Config& config) {
  if (!config.thermal) config.thermal.emplace();
  return *config.thermal;
}

Section<OutputSettings> output_keys() {
  using Its = OutputSettings;
  return Section<Its>("output", "Output")
      .key("every", &Its::every, "Iterations between two dumps of fields; 0: none",
           {.range = "[0, inf)", .unit = "iterations", .option = "-output_every"})
      .key("checkpoint_every", &Its::checkpoint_every, "Iterations between two checkpoints; 0: none",
           {.range = "[0, inf)", .unit = "iterations", .option = "-checkpoint_every"})
      .key("stages", &Its::stages, "Write the displacement after every layer", {.option = "-stages"})
      .key("stress", &Its::stress,
           "Say at the end how large the residual stress is, as if the material never yielded")
      .key("sensitivity", &Its::sensitivity, "End an optimization with the table of -task sensitivity",
           {.option = "-sensitivity"})
      .key("finer_grid", &Its::finer_grid,
           "Sensitivity table with the grid twice as fine, 8 to 16 times the cost of another change; auto: "
           "if memory allows",
           {.words = "auto", .option = "-finer_grid"});
}

void add_part(Section<Config>& keys) {
  using Its = Config;
  const Section<NodeSetDescription> set_keys = node_set_keys();
  const auto shape_of = [](std::optional<Shape> PartDescription::*member) {
    return [member](Its& config, const Json& value, const KeyPlace& place) {
      config.part.*member = make_shape(value, place);
    };
  };
  keys.section("part", &Its::part, "What is built", part_keys(), {.type = KeyType::part, .required = true})
      .key("build_plate", "Face of the box that is the build plate",
           {.type = KeyType::face,
            .default_value = to_text("z-"),
            .default_2d = to_text("y-"),
            .option = "-build_plate"},
           [](Its& config, const Json& value, const KeyPlace&) {
             config.plate = make_plate(value.get<std::string>());
           })
      .key("substrate", "Stands from the start, such as a base plate: elements whose centre is in the shape",
           {.type = KeyType::shape}, shape_of(&PartDescription::substrate))
      .key("stock",
           "Is built, too, and machined away afterwards, as what fills a hole: elements whose centre is in "
           "the shape",
           {.type = KeyType::shape}, shape_of(&PartDescription::stock))
      .key("clamps",
           "Nodes in the shape are held instead of the plate's; without it, with a substrate: its lowest "
           "nodes",
           {.type = KeyType::shape}, shape_of(&PartDescription::clamps))
      .key(
          "node_sets", "Sets of nodes for distortion terms: those in a shape that touch part or substrate",
          {.type = KeyType::node_sets, .default_value = "{}"},
          [set_keys](Its& config, const Json& value, const KeyPlace& place) {
            for (const auto& [name, set] : value.items())
              set_keys.read(config.node_sets[name], set, {pointer_to(place.pointer, name), place.dimension});
          },
          [set_keys](Its& config, Json& object) {
            for (auto& [name, set] : config.node_sets) set_keys.write(set, object["node_sets"][name]);
          });
  for (SectionKeys& section : set_keys.declarations()) keys.declare(std::move(section));
}

void add_sequence(Section<Config>& keys) {
  for (SectionKeys& section : sequence_keys()) keys.declare(std::move(section));
  keys.key(
      "sequence", "Fabrication sequence", {.type = KeyType::section, .required = true},
      [](Config& config, const Json& value, const KeyPlace& place) {
        config.sequence = read_sequence(value, place);
      },
      [](Config& config, Json& object) { config.sequence.kind->write(config.sequence, object["sequence"]); });
}

void add_terms(Section<Config>& keys) {
  using Its = Config;
  const auto terms_of = [](std::vector<Term> ModelSettings::*member, TermList list) {
    return [member, list](Its& config, const Json& value, const KeyPlace&) {
      std::vector<Term>& terms = config.*member;
      for (const Json& term : value) {
        terms.push_back(make_term(list, term));
        terms.back().position = terms.size() - 1;
      }
    };
  };
  const auto terms_left = [](std::vector<Term> ModelSettings::*member, const char* name) {
    return [member, name](Its& config, Json& object) {
      Json left = Json::array();
      for (Term& term : config.*member) {
        left.push_back(object[name][term.position]);
        term.position = left.size() - 1;
      }
      object[name] = std::move(left);
    };
  };
  keys.key("objective", "Terms, summed with their weights", {.type = KeyType::sections, .required = true},
           terms_of(&Its::objective, TermList::objective), terms_left(&Its::objective, "objective"))
      .key("constraints", "Constraints", {.type = KeyType::sections, .default_value = "[]"},
           terms_of(&Its::constraints, TermList::constraints), terms_left(&Its::constraints, "constraints"))
      .declare(term_keys(TermList::objective))
      .declare(term_keys(TermList::constraints));
}

Section<Config> all_keys() {
  using Its = Config;
  const ConfigKey required{.required = true}, optional{.default_value = "{}"};
  Section<Its> keys("", "Top level");
  keys.key("name", &Its::name, "Name of the case and of output/NAME", {.option = "-name"})
      .key("machine",
           "JSON file with the entries of a machine, beside the config or one of configs/machines; keys of "
           "the config replace what follows from them",
           {.type = KeyType::path, .option = "-machine"}, [](Its&, const Json&, const KeyPlace&) {})
      .section("domain", base_of<DomainSettings>, "Box and grid", domain_keys(), required);
  add_part(keys);
  keys.section("material", &Its::material, "Material", material_keys(), optional)
      .section("process", &Its::process, "Process simulation", process_keys(), optional)
      .section("thermal", thermal_of,
               "Heat conduction; needs material.mass_density and process.deposition_rate", thermal_keys());
  add_sequence(keys);
  keys.section("layers", &Its::layers, "Layers", layer_keys(), required)
      .section("projection", &Its::projection, "Sharpness of the layers", projection_keys(), optional);
  add_terms(keys);
  return keys.section("baseline", &Its::baseline, "Sequences for comparison", baseline_keys(), optional)
      .section("tool", &Its::tool, "Torch and bead", tool_keys(), optional)
      .section("optimizer", &Its::optimizer, "Optimizer", optimizer_keys(), optional)
      .section("solver", &Its::solver, "Linear solver", solver_keys(), optional)
      .section("output", &Its::output, "Output", output_keys(), optional)
      .declare(machine_entries().declarations().front());
}

}  // namespace

const Section<Config>& config_section() {
  static const Section<Config> section = all_keys();
  return section;
}

const std::vector<SectionKeys>& config_sections() {
  static const std::vector<SectionKeys> sections = config_section().declarations();
  return sections;
}

std::string dotted_path(const ConfigKey& key) {
  if (key.variant.empty()) return subsection(key);
  for (const SectionKeys& section : config_sections())
    for (const ConfigKey& list : section.keys)
      if (list.type == KeyType::sections && subsection(list) == key.section)
        return key.section + "." + key.variant + "." + key.name;
  return subsection(key);
}

std::vector<const ConfigKey*> keys_with_option() {
  std::vector<const ConfigKey*> result;
  for (const SectionKeys& section : config_sections())
    for (const ConfigKey& key : section.keys)
      if (!key.option.empty()) result.push_back(&key);
  return result;
}

}  // namespace fabseq
