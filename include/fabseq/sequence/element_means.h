// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/part/part.h"
#include "fabseq/sequence/sequence.h"

#include <span>
#include <vector>

namespace fabseq {

/// Mean of the nodal values of each part element (a part field), and the gradient of these values at its
/// centre, [part element][axis].
struct ElementMeans {
  std::vector<double> mean, gradient;
};

/// Means and gradients of a nodal field. `nodal`: its values on the ghosted node box. Local.
template <int Dim>
ElementMeans element_means(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                           std::span<const double> nodal);

/// The gradients alone, [lane][part element x axis], of nodal values on the owned nodes. Collective on the
/// grid's communicator.
template <int Dim>
std::vector<std::vector<double>> element_gradients(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                                                   const LaneVector& nodal);

/// The transpose of element_means(): derivatives with respect to the nodal values, on the owned nodes, from
/// those with respect to means (`time`) and gradients. One lane per row. Collective on the grid's
/// communicator.
template <int Dim>
LaneVector pull_back_means(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                           std::span<const TimeDerivatives> rows);

}  // namespace fabseq
