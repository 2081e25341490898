// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"

namespace fabseq {

struct HeatSettings;

/// Characteristic length with which admissible diffusivities give even layers that make `height` together
/// (docs/formulation.md 2.1, "matched drain"): `height`, and more where the part widens above a narrow
/// section, which more heat must pass than conducts there. Length unit. Collective on the grid's
/// communicator.
template <int Dim>
double drain_length(const Part<Dim>& part, const HeatSettings& settings, double height);

}  // namespace fabseq
