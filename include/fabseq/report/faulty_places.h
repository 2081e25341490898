// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/machine/places.h"

namespace fabseq {

/// Where the checks fail, and what these places are measured by.
struct FaultyPlaces : Places {
  Bead bead;
  double part_volume = 0.0;
};

}  // namespace fabseq
