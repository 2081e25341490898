// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"
#include "fabseq/machine/tool_settings.h"

#include <vector>

namespace fabseq {

/// Points that fill a torch with its clearance, relative to its tip and for an axis along the plate's normal
/// `up`: denser near the tip, which comes nearest to the bead, and even over the disc at each height
/// (docs/formulation.md 13.2). Not collective.
/// \param settings  with a profile
/// \param highest   height above which there is nothing that the torch could meet, length unit
/// \param count     number of points
template <int Dim>
std::vector<Point<Dim>> torch_samples(const ToolSettings& settings, const Point<Dim>& up, double highest,
                                      int count);

}  // namespace fabseq
