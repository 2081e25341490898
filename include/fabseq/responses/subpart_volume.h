// SPDX-License-Identifier: MIT
/// \file
/// Constraint: no sub-part has more than its share of the part (docs/formulation.md 7).
#pragma once

#include "fabseq/responses/response.h"

#include <memory>

namespace fabseq {

/// Components V_i / (V* / N_P) - 1, one a sub-part, each at most `tolerance`. NaN without sub-parts.
template <int Dim>
std::unique_ptr<Response<Dim>> make_subpart_volume(const ResponseContext<Dim>& context, double tolerance);

}  // namespace fabseq
