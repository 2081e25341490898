// SPDX-License-Identifier: MIT
/// \file
/// Objective: lines between sub-parts shall be short, and across the print direction of what comes next
/// (docs/formulation.md 7).
#pragma once

#include "fabseq/responses/response.h"

#include <memory>

namespace fabseq {

/// sum_{i < N_P} sum_e rho_e E_B (v . n_{i+1} + 1), E_B the elements up to `band` in pseudo-time after
/// timestamp i, v = -grad t / |grad t|. NaN without sub-parts.
template <int Dim>
std::unique_ptr<Response<Dim>> make_segmentation_alignment(const ResponseContext<Dim>& context, double band);

}  // namespace fabseq
