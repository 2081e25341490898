// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/report/real_layers.h"
#include "tasks/variation.h"

#include <optional>

namespace fabseq {

/// Simulates a sequence and planar layers in simulated layers and in the real ones that these stand for.
/// None, with a warning, where that is refused, fails or is stopped: the optimized sequence shall not be
/// lost. Collective on the world of the setup.
template <int Dim>
std::optional<Lumping> simulate_lumping(const Setup<Dim>& setup, const GivenDesign<Dim>& given,
                                        PhaseTimer& timer);

}  // namespace fabseq
