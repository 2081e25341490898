// SPDX-License-Identifier: MIT
/// \file
/// Objective: |grad t| shall be uniform within each layer (docs/formulation.md 6).
#pragma once

#include "fabseq/responses/response.h"

#include <memory>

namespace fabseq {

/// `sum_of_squares`: sum over layers of sum_e drho_e (M_e - m_j)^2.
template <int Dim>
std::unique_ptr<Response<Dim>> make_sum_of_squares_uniformity(const ResponseContext<Dim>& context);

/// `variance`: mean over the layers that are not empty of the squared coefficient of variation; free of
/// scales.
template <int Dim>
std::unique_ptr<Response<Dim>> make_variance_uniformity(const ResponseContext<Dim>& context);

}  // namespace fabseq
