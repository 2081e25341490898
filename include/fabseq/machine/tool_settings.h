// SPDX-License-Identifier: MIT
/// \file
/// The torch and the bead that it lays.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

template <class Settings>
class Section;

/// Section "tool".
struct ToolSettings {
  std::string name;  ///< of the machine, a label; empty: none
  /// The torch, a body of revolution around the build direction: height above its tip and radius there, both
  /// in length units, ascending. Empty: there is none.
  std::vector<std::array<double, 2>> profile;
  std::vector<double> axis;           ///< of the torch in the box, of any length; empty: the build direction
  double clearance = 0.0;             ///< distance that the torch keeps from what is there, length unit
  double max_tilt = 180.0;            ///< of the torch's axis from the plate's normal, degrees
  double bead_width = 0.0;            ///< length unit; 0: two elements' longest edges
  std::optional<double> bead_height;  ///< length unit; none: not known. A layer may stand for several beads
  /// Least and largest local thickness of a layer that the process can deposit, relative to the target.
  std::array<double, 2> thickness = {0.5, 1.5};
  /// Places smaller than a bead, and the share of the part on them, with which a sequence is still buildable
  /// but for them.
  int most_places = 5;
  double places_share = 0.005;
  std::optional<double> bridge;        ///< span that a bead bridges, length unit; none: two widths of a bead
  std::optional<double> travel_speed;  ///< of the torch while it welds, length unit/s; none: not known
  std::vector<double> plate;           ///< its two edges, in any order, length unit; empty: not known
};

Section<ToolSettings> tool_keys();

}  // namespace fabseq
