// SPDX-License-Identifier: MIT
#include "fabseq/keys/section.h"
#include "fabseq/layers/layer_settings.h"

#include <cstddef>
#include <numbers>

namespace fabseq {

namespace {

/// Returns the direction of the plate's normal, as an angle in 2D, elevation and azimuth in 3D.
std::vector<double> normal_angles(const BuildPlate& plate, int dimension) {
  const double half_turn = std::numbers::pi, sign = plate.upper ? -1.0 : 1.0;
  if (plate.axis == dimension - 1)
    return dimension == 2 ? std::vector<double>{0.5 * half_turn * sign}
                          : std::vector<double>{0.5 * half_turn * sign, 0.0};
  const double in_plane = plate.axis == 0 ? (plate.upper ? half_turn : 0.0) : 0.5 * half_turn * sign;
  return dimension == 2 ? std::vector<double>{in_plane} : std::vector<double>{0.0, in_plane};
}

/// Rows of numbers, one for each sub-part, or "auto".
void read_angles(MultiPlanarSettings& layers, const Json& value, const KeyPlace&) {
  if (!value.is_array()) return;
  for (const Json& row : value)
    for (const Json& angle : row) layers.angles.push_back(angle.get<double>());
}

/// A pair for all angles, a pair for each angle of a direction, or one for each angle of each sub-part.
void read_angle_bounds(MultiPlanarSettings& layers, const Json& value, const KeyPlace&) {
  for (const Json& pair : value[0].is_number() ? Json::array({value}) : value) {
    layers.lowest_angles.push_back(pair[0].get<double>());
    layers.highest_angles.push_back(pair[1].get<double>());
  }
}

void read_fixed(MultiPlanarSettings& layers, const Json& value, const KeyPlace&) {
  for (const Json& word : value) (word == "angles" ? layers.fixed_angles : layers.fixed_time) = true;
}

Section<MultiPlanarSettings> sharpness_keys() {
  using Its = MultiPlanarSettings;
  return Section<Its>("layers.sharpness", "Sharpness of multi-planar layers")
      .key("time", &Its::time_sharpness, "k1, of the steps between sub-parts", {.range = "(0, inf)"})
      .key("slab", &Its::slab_sharpness, "k2, of the faces of the layers", {.range = "(0, inf)"});
}

Section<MultiPlanarSettings> multi_planar_keys() {
  using Its = MultiPlanarSettings;
  return Section<Its>("layers")
      .key("subparts", &Its::subparts, "Number of sub-parts, built one after the other",
           {.required = true, .range = "[1, 100]", .option = "-subparts"})
      .key("timestamps", &Its::timestamps, "Pseudo-times between the sub-parts; auto: equal steps",
           {.type = KeyType::list, .range = "(0, 1)", .words = "auto"})
      .key("thickness", &Its::thickness, "Thickness of the layers",
           {.range = "(0, inf)", .unit = "length", .option = "-layer_thickness"})
      .key("origin", &Its::origin,
           "Point from which heights are measured that cut the layers; auto: lower corner of the box",
           {.type = KeyType::list, .words = "auto", .unit = "length"})
      .key("angles",
           "Initial print direction of each sub-part: 2D angle to the x axis, 3D elevation and azimuth; "
           "auto: the plate's normal",
           {.type = KeyType::angles, .default_value = to_text("auto"), .words = "auto", .unit = "radians"},
           read_angles)
      .key("angle_bounds",
           "Bounds: a pair for all, for each angle of a direction, or for each of each sub-part",
           {.type = KeyType::angle_bounds, .default_value = "[0, 1.5708]", .unit = "radians"},
           read_angle_bounds)
      .section("sharpness", [](Its& layers) -> Its& { return layers; }, "Sharpness", sharpness_keys(),
               {.default_value = "{}"})
      .key("fixed", "Not optimized: angles (segmentation only) or time (orientation only)",
           {.type = KeyType::word_list, .default_value = "[]", .words = "angles time"}, read_fixed);
}

}  // namespace

Section<LayerSettings> layer_keys() {
  using Its = LayerSettings;
  Section<Its> keys("layers", "Layers");
  keys.key("type", "Between isosurfaces of the pseudo-time, or planar in sub-parts",
           {.type = KeyType::choice, .default_value = to_text("curved"), .words = "curved multi_planar"},
           [](Its& layers, const Json& value, const KeyPlace&) {
             if (value == "multi_planar") layers.multi_planar.emplace();
           })
      .key("passes", &Its::passes,
           "Real layers, each a bead high, that a simulated layer stands for; thicknesses are those of real "
           "layers",
           {.range = "[1, 1000]", .unit = "layers"});
  keys.only_for("curved")
      .key("count", &Its::count, "Number of layers; auto: geodesic height over target thickness, rounded up",
           {.required = true,
            .range = "[1, " + std::to_string(most_layers) + "]",
            .words = "auto",
            .option = "-layers"})
      .key("target", &Its::given_target,
           "Target thickness, to which tool.thickness is relative; auto: the first constraint with a target "
           "says it",
           {.range = "(0, inf)", .words = "auto", .unit = "length"})
      .key("time_points", &Its::variable_time_points,
           "Pseudo-times at which layers end: equal steps, or variables",
           {.words = "uniform variable", .option = "-time_points"});
  keys.only_for("multi_planar")
      .keys([](Its& layers) -> MultiPlanarSettings& { return *layers.multi_planar; }, multi_planar_keys());
  return keys;
}

Section<ProjectionSettings> projection_keys() {
  using Its = ProjectionSettings;
  return Section<Its>("projection", "Sharpness of the layers and its continuation")
      .key("beta", &Its::beta, "Sharpness at the start; auto: 4 times the number of layers",
           {.range = "(0, inf)", .words = "auto", .option = "-beta"})
      .key("factor", &Its::factor, "Factor of the sharpness at every step",
           {.range = "[1, inf)", .option = "-beta_factor"})
      .key("increment", &Its::increment, "Added at every step",
           {.range = "[0, inf)", .option = "-beta_increment"})
      .key("interval", &Its::interval, "Iterations between two steps",
           {.range = "[1, inf)", .unit = "iterations", .option = "-beta_interval"})
      .key("max", &Its::max, "Last sharpness; auto: 13.5 times the number of layers",
           {.range = "(0, inf)", .words = "auto", .option = "-beta_max"})
      .key("binary", &Its::binary, "Binary layers, for simulate and evaluate", {.option = "-binary"});
}

void complete_layers(MultiPlanarSettings& layers, const BuildPlate& plate, int dimension) {
  if (layers.timestamps.empty())
    for (int i = 1; i < layers.subparts; ++i)
      layers.timestamps.push_back(static_cast<double>(i) / layers.subparts);
  if (layers.angles.empty()) {
    const std::vector<double> normal = normal_angles(plate, dimension);
    for (int i = 0; i < layers.subparts; ++i)
      layers.angles.insert(layers.angles.end(), normal.begin(), normal.end());
  }
  const std::size_t pairs = layers.lowest_angles.size();
  for (std::vector<double>* bounds : {&layers.lowest_angles, &layers.highest_angles}) {
    const std::vector<double> given = *bounds;
    bounds->resize(layers.angles.size());
    for (std::size_t i = 0; i < bounds->size(); ++i) (*bounds)[i] = given[i % pairs];
  }
}

}  // namespace fabseq
