// SPDX-License-Identifier: MIT
/// \file
/// Constraint: no layer vanishes (docs/formulation.md 7).
#pragma once

#include "fabseq/responses/response.h"

#include <memory>

namespace fabseq {

/// Components V_min - (volume of layer j), each at most 0; V_min is `fraction` of the part's volume. With
/// variable time points this keeps them in order, too: a layer that ends before it begins has a negative
/// volume.
template <int Dim>
std::unique_ptr<Response<Dim>> make_minimum_layer_volume(const ResponseContext<Dim>& context,
                                                         double fraction);

}  // namespace fabseq
