// SPDX-License-Identifier: MIT
/// \file
/// Constraint: the mean thickness of every layer stays near its target (docs/formulation.md 6).
#pragma once

#include "fabseq/responses/response.h"

#include <memory>

namespace fabseq {

/// Components d_j / target, each between 1 - tolerance and 1 + tolerance. Layers with less than
/// `least_volume` of the mean volume V*/N fade towards 1, which they reach where they vanish; 0: none does.
template <int Dim>
std::unique_ptr<Response<Dim>> make_layer_thickness(const ResponseContext<Dim>& context, double target,
                                                    double tolerance, double least_volume = 0.0);

}  // namespace fabseq
