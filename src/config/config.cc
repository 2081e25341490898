// SPDX-License-Identifier: MIT
#include "fabseq/config/config.h"

#include "config/config_keys.h"
#include "fabseq/base/error.h"
#include "fabseq/base/refusal.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/sequence/sequence_kind.h"

namespace fabseq {

namespace {

ToolRange range_of(const ToolSettings& tool) {
  ToolRange range{tool.max_tilt};
  if (!tool.profile.empty()) range.thickness = tool.thickness;
  return range;
}

}  // namespace

bool Config::needs_time_gradient(const ResponseType& type) const {
  return type.needs_time_gradient || (type.needs_torch_axis && tool.axis.empty());
}

bool Config::has_layers_of(const ResponseType& type) const {
  return type.layers == LayerKind::any ||
         type.layers == (layers.multi_planar ? LayerKind::multi_planar : LayerKind::curved);
}

std::optional<TargetThickness> target_thickness(const Config& config) {
  const auto target_of = [&](double bead, const std::string& key) {
    return TargetThickness{config.layers.passes * bead, key, bead};
  };
  if (config.layers.given_target) return target_of(*config.layers.given_target, "/layers/target");
  for (std::size_t i = 0; i < config.constraints.size(); ++i)
    if (const auto target = config.constraints[i].type->facts(config.constraints[i]).target_thickness)
      return target_of(*target, "/constraints/" + std::to_string(i) + "/target");
  return std::nullopt;
}

Config read_settings(const Json& document, const std::string& directory,
                     std::shared_ptr<const PlacedMesh> mesh) {
  Config config;
  config.part.mesh = std::move(mesh);
  config.effective = complete_config(document, directory);
  const auto dimension = static_cast<int>(config.effective.at("domain").at("elements").size());
  config_section().read(config, config.effective, {"", dimension});
  return config;
}

void complete(Config& config) {
  if (config.layers.multi_planar) {
    config.layers.multi_planar->passes = config.layers.passes;
    complete_layers(*config.layers.multi_planar, config.plate, config.dimension());
  }
  if (config.thermal) config.thermal->passes = config.thermal->given_passes.value_or(config.layers.passes);
  config.layers.target = target_thickness(config);
  config.sequence.kind->follow_tool(config.sequence, range_of(config.tool));
  complete_move_limits(config.optimizer, config.sequence, config.objective);
  check_rules(config);
}

SequenceSettings with_start(const Config& config, const Json& sequence, std::size_t start) {
  const std::string pointer = pointer_to("/optimizer/starts", start), initial = "/sequence/initial";
  const SequenceKind& kind = *config.sequence.kind;
  Json object = sequence;
  const Json& value = config.optimizer.starts[start];
  if (find_member(object, "initial") == nullptr)
    refuse(pointer, shown(value) + " with sequence type \"" + kind.name + "\", which has no key initial",
           "no starts with this type");
  object["initial"] = value;
  try {
    object = complete_section(object, "/sequence", "sequence", config.dimension(), "");
    SequenceSettings result = read_sequence(object, {"/sequence", config.dimension()});
    kind.follow_tool(result, range_of(config.tool));
    kind.check(result, object);
    return result;
  } catch (const InputError& error) {
    const std::string message = error.what();
    throw InputError(message.starts_with(initial) ? pointer + message.substr(initial.size()) : message);
  }
}

void complete_derived(Config& config) {
  config_section().write(config, config.effective);
  complete(config);
}

Config make_config(const Json& document, const std::string& directory,
                   std::shared_ptr<const PlacedMesh> mesh) {
  Config config = read_settings(document, directory, std::move(mesh));
  complete(config);
  return config;
}

}  // namespace fabseq
