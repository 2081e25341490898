// SPDX-License-Identifier: MIT
/// Relations between the keys of "layers" and of "projection".
#include "fabseq/base/refusal.h"
#include "fabseq/keys/message.h"
#include "fabseq/layers/layer_settings.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>

namespace fabseq {

namespace {

void check_angles(const MultiPlanarSettings& layers, const Json& keys, int dimension) {
  const auto angles = static_cast<std::size_t>(dimension) - 1,
             subparts = static_cast<std::size_t>(layers.subparts);
  const std::string of_subparts = " for " + std::to_string(subparts) + " sub-parts";
  const Json& directions = keys.at("angles");
  if (directions.is_array() && directions.size() != subparts)
    refuse("/layers/angles", shown(directions) + of_subparts, "a list of angles for each of them");
  const Json& bounds = keys.at("angle_bounds");
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

/// `config`: the completed config.
void check_multi_planar(const MultiPlanarSettings& layers, const Json& config, int dimension) {
  const Json &keys = config.at("layers"), &projection = config.at("projection");
  const std::vector<double>& timestamps = layers.timestamps;
  const Json& times = keys.at("timestamps");
  if ((times.is_array() && times.size() + 1 != static_cast<std::size_t>(layers.subparts)) ||
      !std::is_sorted(timestamps.begin(), timestamps.end(), std::less_equal<>()))
    refuse("/layers/timestamps", shown(times),
           "\"auto\" or " + std::to_string(layers.subparts - 1) +
               " ascending numbers in (0, 1), one less than subparts");
  const Json& origin = keys.at("origin");
  if (origin.is_array() && origin.size() != static_cast<std::size_t>(dimension))
    refuse("/layers/origin", shown(origin), "\"auto\" or " + std::to_string(dimension) + " numbers");
  check_angles(layers, keys, dimension);
  if (layers.fixed_angles && layers.fixed_time)
    refuse("/layers/fixed", shown(keys.at("fixed")), "[], [\"angles\"] or [\"time\"]");
  for (const char* key : {"beta", "max"})
    if (projection.at(key).is_number())
      refuse(pointer_to("/projection", std::string(key)), shown(projection.at(key)),
             "\"auto\" with layers of type multi_planar, whose sharpness is layers.sharpness");
}

void check_curved(const LayerSettings& layers) {
  if (layers.count || layers.target) return;
  refuse("/layers/count", "\"auto\" without layers.target and a layer_thickness constraint",
         "an integer in [1, " + std::to_string(most_layers) +
             "], or \"auto\" with layers.target or a constraint of type layer_thickness");
}

/// `keys`: the completed section.
void check_projection(const ProjectionSettings& projection, const LayerSettings& layers, const Json& keys) {
  if ((!projection.beta && !layers.count) || !projection.max) return;
  const double start = projection.first_beta(layers.count.value_or(1));
  if (*projection.max >= start) return;
  const char* origin = projection.beta ? " (beta)" : " (beta, 4 times the number of layers)";
  refuse("/projection/max", shown(keys.at("max")), "\"auto\" or a number >= " + shown(start) + origin);
}

}  // namespace

void check_layers(const LayerSettings& layers, const ProjectionSettings& projection, const Json& config,
                  int dimension) {
  if (layers.multi_planar)
    check_multi_planar(*layers.multi_planar, config, dimension);
  else
    check_curved(layers);
  check_projection(projection, layers, config.at("projection"));
}

}  // namespace fabseq
