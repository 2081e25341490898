// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/sequence/sequence.h"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace fabseq {

/// The design that a guided sequence begins with.
enum class GuidedStart { distance, planar, direction };

/// Settings of a guided sequence (docs/formulation.md 2.4). What "auto" stands for follows from the tool and
/// from the part.
struct GuidedSettings {
  std::optional<double> given_max_tilt;          ///< degrees; none: the tool's, or default_tilt
  double max_tilt = default_tilt;                ///< what holds: bound of each component of the tilt vector
  bool stretch_of_tool = true;                   ///< whether the stretch is the tool's range of thicknesses
  std::optional<std::array<double, 2>> stretch;  ///< bounds of the thickness relative to the target; or none
  std::optional<double> filter_radius;           ///< length unit; 0: no filter; none: two elements
  double void_diffusivity = 1e-4;
  std::optional<double> characteristic_length;  ///< length unit; none: N times the target thickness
  GuidedStart start = GuidedStart::distance;
  std::vector<double> direction;  ///< of GuidedStart::direction, of any length

  static constexpr double default_tilt = 60.0;

  /// Variables of an element of a box with that many dimensions.
  int components(int dimension) const { return dimension - 1 + (stretch ? 1 : 0); }
  /// max_tilt in radians.
  double tilt_bound() const { return max_tilt * std::numbers::pi / 180.0; }
  /// Bounds of the variables of an element.
  DesignSpace space(int dimension) const {
    DesignSpace result{std::vector<DesignScale>(dimension - 1, {-tilt_bound(), tilt_bound()})};
    if (stretch) result.components.push_back({std::log((*stretch)[0]), std::log((*stretch)[1])});
    return result;
  }
};

}  // namespace fabseq
