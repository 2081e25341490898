// SPDX-License-Identifier: MIT
/// The layers of a config: curved, or planar ones in sub-parts.
#include "fabseq/config/config_rules.h"

#include <cstddef>
#include <numbers>

namespace fabseq {

namespace {

/// Along the plate's normal, as an angle in 2D, elevation and azimuth in 3D.
std::vector<double> normal_angles(const BuildPlate& plate, int dimension) {
  const double half_turn = std::numbers::pi, sign = plate.upper ? -1.0 : 1.0;
  if (plate.axis == dimension - 1)
    return dimension == 2 ? std::vector<double>{0.5 * half_turn * sign}
                          : std::vector<double>{0.5 * half_turn * sign, 0.0};
  const double in_plane = plate.axis == 0 ? (plate.upper ? half_turn : 0.0) : 0.5 * half_turn * sign;
  return dimension == 2 ? std::vector<double>{in_plane} : std::vector<double>{0.0, in_plane};
}

/// Rows of numbers, as many as there are sub-parts.
std::vector<double> angles_of(const Json& value, int subparts, const std::vector<double>& automatic) {
  std::vector<double> result;
  for (int i = 0; !value.is_array() && i < subparts; ++i)
    result.insert(result.end(), automatic.begin(), automatic.end());
  if (!value.is_array()) return result;
  for (const Json& row : value) {
    const std::vector<double> angles = row.get<std::vector<double>>();
    result.insert(result.end(), angles.begin(), angles.end());
  }
  return result;
}

/// A pair for all angles, a pair for each angle of a direction, or one for each angle of each sub-part.
void set_angle_bounds(MultiPlanarSettings& settings, const Json& value) {
  const bool single = value[0].is_number();
  const std::size_t pairs = single ? 1 : value.size();
  for (std::size_t i = 0; i < settings.angles.size(); ++i) {
    const Json& pair = single ? value : value[i % pairs];
    settings.lowest_angles.push_back(pair[0].get<double>());
    settings.highest_angles.push_back(pair[1].get<double>());
  }
}

MultiPlanarSettings make_multi_planar(const Json& value, const BuildPlate& plate, int dimension) {
  MultiPlanarSettings settings;
  settings.subparts = static_cast<int>(value.at("subparts").get<std::int64_t>());
  const Json& timestamps = value.at("timestamps");
  if (timestamps.is_array()) settings.timestamps = timestamps.get<std::vector<double>>();
  for (int i = 1; !timestamps.is_array() && i < settings.subparts; ++i)
    settings.timestamps.push_back(static_cast<double>(i) / settings.subparts);
  settings.thickness = value.at("thickness").get<double>();
  settings.angles = angles_of(value.at("angles"), settings.subparts, normal_angles(plate, dimension));
  set_angle_bounds(settings, value.at("angle_bounds"));
  settings.time_sharpness = value.at("sharpness").at("time").get<double>();
  settings.slab_sharpness = value.at("sharpness").at("slab").get<double>();
  for (const Json& word : value.at("fixed"))
    (word.get<std::string>() == "angles" ? settings.fixed_angles : settings.fixed_time) = true;
  return settings;
}

}  // namespace

LayerSettings make_layer_settings(const Json& value, const BuildPlate& plate, int dimension) {
  LayerSettings layers;
  if (value.at("type").get<std::string>() == "multi_planar") {
    layers.multi_planar = make_multi_planar(value, plate, dimension);
    return layers;
  }
  const Json& count = value.at("count");
  if (count.is_number_integer()) layers.count = static_cast<int>(count.get<std::int64_t>());
  layers.variable_time_points = value.at("time_points").get<std::string>() == "variable";
  return layers;
}

}  // namespace fabseq
