// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/part/part.h"
#include "sequence/guided_settings.h"

#include <vector>

namespace fabseq {

/// The design that a guided sequence begins with, [part element][component], before any filter
/// (docs/formulation.md 2.4): the directions of the distance from the plate inside the part, limited to the
/// largest tilt; the plate's normal; or a direction. The thickness is the target, or the end of the stretch
/// next to it. Collective on the grid's communicator.
template <int Dim>
std::vector<double> guided_start(const Part<Dim>& part, const GuidedSettings& settings,
                                 const ElementMatrices<Dim>& element);

/// Throws InputError if a direction to start from leaves the bounds of the tilt vector. Not collective.
template <int Dim>
void require_start_within_tilt(const BuildPlate& plate, const GuidedSettings& settings);

}  // namespace fabseq
