// SPDX-License-Identifier: MIT
/// \file
/// How the pseudo-time is cut into layers.
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/part/pieces.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

template <class Settings>
class Section;

/// No part has as many layers; more are a slip, such as a target thickness in another unit.
constexpr int most_layers = 10000;

/// Sub-parts of planar layers, docs/formulation.md 3.2.
struct MultiPlanarSettings {
  int subparts = 1;                ///< N_P
  std::vector<double> timestamps;  ///< tau_1 ... tau_{N_P - 1}, ascending
  double thickness = 3.0;          ///< of a real layer, length unit
  std::vector<double> origin;  ///< of the heights that slabs are counted by; empty: the box's lower corner
  int passes = 1;              ///< LayerSettings::passes, once complete
  /// Start angles and their bounds: [sub-part][angle], radians; 2D one angle, 3D elevation and azimuth.
  std::vector<double> angles, lowest_angles, highest_angles;
  double time_sharpness = 100.0;                  ///< k1
  double slab_sharpness = 10.0;                   ///< k2; less than published (results/multi_planar.md)
  bool fixed_angles = false, fixed_time = false;  ///< kept from the optimizer

  /// w, thickness of a simulated layer, length unit.
  double slab_thickness() const { return passes * thickness; }
};

/// How thick layers shall be, length unit, and the key that says so.
struct TargetThickness {
  double value = 0.0;  ///< of a simulated layer
  std::string key;
  double bead = 0.0;  ///< of a real layer, as the key has it
};

struct LayerSettings {
  std::optional<int> count;                              ///< none: ceil(geodesic height / target thickness)
  int passes = 1;                                        ///< k, real layers that a simulated one stands for
  std::optional<double> given_target = std::nullopt;     ///< of real layers; none: the constraints say it
  std::optional<TargetThickness> target = std::nullopt;  ///< what counts, where there is any
  bool variable_time_points = false;                     ///< T_1 ... T_{N-1} are design variables
  std::optional<MultiPlanarSettings> multi_planar = std::nullopt;  ///< in place of curved layers

  /// What so many layers of the target thickness make together, length unit; 0: no target.
  double height_of(int layers) const { return target ? layers * target->value : 0.0; }
};

/// Sharpness beta of the layers and its continuation, docs/formulation.md 3.1.
struct ProjectionSettings {
  std::optional<double> beta;  ///< start; none: 4 N
  double factor = 1.5;
  double increment = 0.0;
  int interval = 15;          ///< iterations between two steps
  std::optional<double> max;  ///< none: 13.5 N
  bool binary = false;

  double first_beta(int layers) const { return beta.value_or(4.0 * layers); }
  double last_beta(int layers) const { return max.value_or(13.5 * layers); }
};

/// Sections "layers" and "projection".
Section<LayerSettings> layer_keys();
Section<ProjectionSettings> projection_keys();
/// What "auto" stands for, once the plate is known: equal steps between the sub-parts, print directions along
/// the plate's normal; bounds of the angles for each angle of each sub-part.
void complete_layers(MultiPlanarSettings& layers, const BuildPlate& plate, int dimension);
/// Checks relations between the keys of both sections, once complete_layers() is done. `config`: the
/// completed config, whose values the messages show. Throws InputError. Not collective.
void check_layers(const LayerSettings& layers, const ProjectionSettings& projection, const Json& config,
                  int dimension);

}  // namespace fabseq
