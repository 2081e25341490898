// SPDX-License-Identifier: MIT
/// \file
/// Distortion measures, all quadratic in the displacement (docs/formulation.md 5). `after_release`: of the
/// part cut from its supports, u + v (4.3).
#pragma once

#include "fabseq/responses/response.h"

#include <memory>

namespace fabseq {

/// `displacement`: sum over the set's nodes of |u|^2 (or its mean).
template <int Dim>
std::unique_ptr<Response<Dim>> make_displacement_distortion(const Part<Dim>& part, const NodeSet& nodes,
                                                            bool mean, bool after_release);

/// `flatness` along an axis: mean over the set's nodes of (u_a - mean of u_a)^2.
template <int Dim>
std::unique_ptr<Response<Dim>> make_flatness_distortion(const Part<Dim>& part, const NodeSet& nodes, int axis,
                                                        bool after_release);

/// `layerwise`: sum over layers and all nodes of |increment|^2.
template <int Dim>
std::unique_ptr<Response<Dim>> make_layerwise_distortion();

}  // namespace fabseq
