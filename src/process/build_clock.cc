// SPDX-License-Identifier: MIT
#include "fabseq/process/build_clock.h"

namespace fabseq {

std::optional<BuildClock> build_clock(const MaterialSettings& material, const ProcessSettings& process,
                                      int passes) {
  if (!material.mass_density || !process.deposition_rate) return std::nullopt;
  return BuildClock{*material.mass_density / *process.deposition_rate,
                    passes * process.dwell / seconds_per_hour};
}

}  // namespace fabseq
