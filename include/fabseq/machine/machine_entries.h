// SPDX-License-Identifier: MIT
/// \file
/// What a machine file says, in the words of those who run the machine.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

template <class Settings>
class Section;

/// Entries of a machine file. Lengths are in mm.
struct MachineEntries {
  std::string name;               ///< a label
  std::vector<std::string> axes;  ///< among x, y, z, and what turns and tilts torch or table
  double tilt = 0.0;              ///< largest angle of a build direction from the plate's normal, degrees
  std::vector<std::array<double, 2>> torch;           ///< as ToolSettings::profile; empty: not known
  double clearance = 0.0;                             ///< distance that the torch keeps
  double bead_height = 0.0;                           ///< height of a bead with the usual feed
  std::optional<std::array<double, 2>> bead_heights;  ///< least and largest height that feed and speed make
  double bead_width = 0.0;
  std::optional<double> bridge;           ///< span that a bead bridges
  std::optional<double> deposition_rate;  ///< kg/h
  std::optional<double> travel_speed;     ///< mm/s
  std::optional<double> interpass_limit;  ///< degrees C
  std::vector<double> plate;              ///< edge lengths of the build plate; empty: not known

  /// Whether torch or table tilts, so that the torch stands on the layers.
  bool tilts() const;
};

/// The entries as keys, each in its unit: what stands under `value` in the file.
Section<MachineEntries> machine_entries();

}  // namespace fabseq
