// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/machine/tool_settings.h"
#include "fabseq/part/part.h"

#include <cstdint>
#include <vector>

namespace fabseq {

/// Part elements that no sequence within the machine's tilt can carry (docs/formulation.md 13.6), connected
/// at least by a corner. The same on all ranks.
template <int Dim>
struct UncarriedPlace {
  Point<Dim> lower{}, upper{};  ///< its box, length unit
  double span = 0.0;            ///< its least extent along the plate, length unit
  std::int64_t elements = 0;
  bool is_roof = false;                   ///< it closes a hole, a slot or an arch
  Point<Dim> hole_lower{}, hole_upper{};  ///< box of what it closes; of other places nothing
};

/// Finds those whose span is more than a bead bridges, the largest first. None with a fixed `tool.axis`,
/// whose layers may lean as they like. Collective on the grid's communicator.
template <int Dim>
std::vector<UncarriedPlace<Dim>> find_uncarried(const Part<Dim>& part, const ToolSettings& tool);

/// The span that a bead bridges, length unit: `tool.bridge`, by default two widths of a bead.
template <int Dim>
double bridged_span(const Part<Dim>& part, const ToolSettings& tool);

}  // namespace fabseq
