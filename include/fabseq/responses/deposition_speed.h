// SPDX-License-Identifier: MIT
/// \file
/// Constraint: every stage adds the same volume (docs/formulation.md 7).
#pragma once

#include "fabseq/responses/response.h"

#include <memory>

namespace fabseq {

/// Components V_j / V* - T_j for j = 1 ... N - 1, each between -slack and 0.
template <int Dim>
std::unique_ptr<Response<Dim>> make_deposition_speed(const ResponseContext<Dim>& context, double slack);

}  // namespace fabseq
