// SPDX-License-Identifier: MIT
/// \file
/// Constraint: the part ends with a layer of some size, not with a sliver (docs/formulation.md 6).
#pragma once

#include "fabseq/responses/response.h"

#include <memory>

namespace fabseq {

/// One component: by how much elements are later than the last layer j that holds `least_volume` of the mean
/// volume V*/N or more, (sum_e max(0, N (t_e - T_j) + 0.25)^8)^(1/8) in layers, at most 0.25. So no element
/// belongs to a later layer. 0 where the last of all layers is as large. Curved layers only.
template <int Dim>
std::unique_ptr<Response<Dim>> make_last_layer(const ResponseContext<Dim>& context, double least_volume);

}  // namespace fabseq
