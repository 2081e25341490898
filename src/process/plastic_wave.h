// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/step_systems.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace fabseq {

/// Steps of a plastic process that are solved together, each wave when those before it are done: a block of
/// steps of each group, or the release.
struct PlasticWave {
  int first = 0, count = 0;          ///< its steps; the release comes behind all steps
  std::vector<StepBlock> blocks;     ///< [group] what it solves, counted from `first`; no lanes: nothing
  std::optional<std::size_t> block;  ///< this group's in StepSystems, if it has any
  bool release = false;

  /// Steps that this group solves: lanes.
  int lanes(int group) const { return blocks[group].lanes; }
};

/// The waves of steps that have been dealt out in turn. `release`: whether there is one; the first group has
/// it. Local.
std::vector<PlasticWave> plastic_waves(const StepSystems<3>& systems, bool release);

}  // namespace fabseq
