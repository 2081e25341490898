// SPDX-License-Identifier: MIT
#include "fabseq/config/config.h"

#include "config/config_keys.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/sequence/sequence_kind.h"

namespace fabseq {

namespace {

/// The target thickness of the first constraint that has one.
std::optional<TargetThickness> target_of(const std::vector<Term>& constraints) {
  for (std::size_t i = 0; i < constraints.size(); ++i)
    if (const auto target = constraints[i].type->facts(constraints[i]).target_thickness)
      return TargetThickness{*target, "/constraints/" + std::to_string(i) + "/target"};
  return std::nullopt;
}

}  // namespace

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
  if (config.layers.multi_planar)
    complete_layers(*config.layers.multi_planar, config.plate, config.dimension());
  config.layers.target = target_of(config.constraints);
  ToolRange tool{config.tool.max_tilt};
  if (!config.tool.profile.empty()) tool.thickness = config.tool.thickness;
  config.sequence.kind->follow_tool(config.sequence, tool);
  complete_move_limits(config.optimizer, config.sequence, config.objective);
  check_rules(config);
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
