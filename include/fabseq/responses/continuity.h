// SPDX-License-Identifier: MIT
/// \file
/// Constraint: the pseudo-time has no bumps, and so no layer begins in the air (docs/formulation.md 7).
#pragma once

#include "fabseq/responses/response.h"

#include <memory>

namespace fabseq {

/// Mean over the part elements outside the start region of (t_e - mean t of the face neighbours in the
/// part)^2, at most `limit`. An element without neighbours counts as even. Collective construction.
template <int Dim>
std::unique_ptr<Response<Dim>> make_continuity(const ResponseContext<Dim>& context, double limit);

}  // namespace fabseq
