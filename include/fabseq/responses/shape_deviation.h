// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/responses/set_displacement.h"

#include <memory>

namespace fabseq {

/// What a best fit of a scanned shape may move; translation always.
struct ShapeFit {
  bool rotation = true;
  bool scale = false;  ///< uniform, about the centre of the set
};

/// The deviation of a set's shape once it is aligned (docs/formulation.md 5): the mean over its n nodes of
/// |u - R a|^2, a the least-squares fit of the motions R. Collective construction. Throws InputError naming
/// the node set if the nodes do not determine the fit. Source: fabseq's own.
template <int Dim>
std::unique_ptr<Response<Dim>> make_shape_deviation(const SetDisplacement<Dim>& set, const ShapeFit& fit);

}  // namespace fabseq
