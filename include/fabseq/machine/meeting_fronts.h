// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

#include <span>
#include <vector>

namespace fabseq {

/// Marks the part elements where fronts meet, with 1 (a part field; docs/formulation.md 13.1): the time rises
/// or falls to the neighbours by more than twice what its gradient at the centre says, so the gradient
/// vanishes nearby. The local thickness means nothing there. Empty without a gradient. Collective on the
/// grid's communicator.
/// \param time      pseudo-time, a part field
/// \param gradient  TimeGradient::values
template <int Dim>
std::vector<double> meeting_fronts(const Part<Dim>& part, std::span<const double> time,
                                   std::span<const double> gradient);

}  // namespace fabseq
