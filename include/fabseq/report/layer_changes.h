// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/report/build_class.h"

#include <cstdint>
#include <vector>

namespace fabseq {

/// An element that a repair (docs/formulation.md 13.5) has moved to another layer.
struct MovedElement {
  std::vector<int> element;  ///< index in the grid, [axis]
  int from = 0, to = 0;      ///< layers, from 1
};

/// What a repair has changed; the same on all ranks.
struct LayerChanges {
  std::int64_t repaired = 0;        ///< elements that failed a check and do not now, or are in another layer
  std::vector<MovedElement> moved;  ///< the latter, in the order of the grid's elements
};

/// A repair that was kept, and what it was made of.
struct RepairReport {
  LayerChanges changes;
  BuildClass build_class = BuildClass::not_buildable;  ///< before
  std::int64_t places = 0;                             ///< before
  double rms = 0.0, largest = 0.0;                     ///< displacement of the skin before, length unit
};

}  // namespace fabseq
