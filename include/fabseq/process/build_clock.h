// SPDX-License-Identifier: MIT
/// \file
/// How long a machine takes to build a part.
#pragma once

#include "fabseq/process/process_settings.h"

#include <optional>

namespace fabseq {

/// Time of welding, which goes with the volume, and of the pauses behind layers.
struct BuildClock {
  double hours_per_volume;  ///< of welding, h/length^3
  double pause_hours;       ///< after each simulated layer, h

  /// Hours for a part of that volume (length^3) in so many simulated layers.
  double hours(double volume, double layers) const {
    return hours_per_volume * volume + pause_hours * layers;
  }
};

/// The clock of a process, where each simulated layer stands for `passes` real ones; none without a mass
/// density and a rate of deposition. Not collective.
std::optional<BuildClock> build_clock(const MaterialSettings& material, const ProcessSettings& process,
                                      int passes);

}  // namespace fabseq
