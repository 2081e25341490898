// SPDX-License-Identifier: MIT
#include "process/element_modes.h"

namespace fabseq {

/// The mode of an axis is the sum over lower corners less that over upper ones, of which there are four.
ElementModes::ElementModes(const ElementMatrices<3>& element, const Point<3>& spacing)
    : stiffness_(element.stiffness()),
      slope_{-0.25 / spacing[0], -0.25 / spacing[1], -0.25 / spacing[2]},
      volume_(spacing[0] * spacing[1] * spacing[2]) {}

}  // namespace fabseq
