// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/machine/torch.h"
#include "fabseq/part/part.h"

#include <span>
#include <vector>

namespace fabseq {

/// How deep the torch would have to enter what is there already when it deposits each part element, length
/// unit; 0 where it reaches the element (a part field; docs/formulation.md 13.1). The tip is at the element's
/// centre. What is there are the centres of elements of earlier layers and of the substrate. The depth at a
/// centre is the torch's radius at its height less its distance from the axis, and the largest of them
/// counts. Collective on the grid's communicator; each rank gathers the layers of all elements within the
/// torch's reach.
/// \param axis         torch_axis(), not empty unless the rank has no part elements
/// \param layer_index  the layer that builds each part element, from 1
template <int Dim>
std::vector<double> blocked_depth(const Part<Dim>& part, const Torch& torch, std::span<const double> axis,
                                  std::span<const double> layer_index);

}  // namespace fabseq
