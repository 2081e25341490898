// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/lanes/lane_vector.h"
#include "fabseq/part/part.h"
#include "fabseq/sequence/sequence.h"

#include <span>
#include <vector>

namespace fabseq {

/// Of each part element: the mean of its nodes' values, and the gradient at its centre, [part element][axis].
struct ElementMeans {
  std::vector<double> mean, gradient;
};

/// `nodal`: on the ghosted node box. Local to the rank.
template <int Dim>
ElementMeans element_means(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                           std::span<const double> nodal);

/// The transpose: derivatives by the nodal values from those by means (`time`) and gradients, on the owned
/// nodes, a row a lane. Collective.
template <int Dim>
LaneVector pull_back_means(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                           std::span<const TimeDerivatives> rows);

}  // namespace fabseq
