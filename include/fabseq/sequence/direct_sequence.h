// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"
#include "fabseq/sequence/design_support.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/sequence/start_region.h"

#include <memory>
#include <span>

namespace fabseq {

/// The pseudo-time itself as design (docs/formulation.md 2.3). Pseudo-time of elements: t_e is the design,
/// and 0 in the start region; its gradient is not defined. Pseudo-time of nodes: t_e is the mean of the
/// element's nodes, grad t that of the bilinear field at its centre. Which of them, `support` says. With a
/// filter radius (length units) these times are the design smoothed inside the part (RepeatedAveraging).
/// Part, support and region must outlive the sequence. Collective.
template <int Dim>
std::unique_ptr<Sequence<Dim>> make_direct_sequence(const Part<Dim>& part, const DesignSupport<Dim>& support,
                                                    const StartRegion& region, double filter_radius = 0.0);

}  // namespace fabseq
