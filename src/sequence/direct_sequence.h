// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/part/part.h"
#include "fabseq/sequence/design_support.h"
#include "fabseq/sequence/sequence.h"
#include "fabseq/sequence/start_region.h"

#include <memory>
#include <optional>

namespace fabseq {

/// Settings of a direct sequence (docs/formulation.md 2.3).
struct DirectSettings {
  DesignLocation location = DesignLocation::elements;  ///< where the pseudo-time lives
  std::optional<Shape> start;                          ///< where the pseudo-time is 0; none: on the plate
  double filter_radius = 0.0;                          ///< length unit; 0: no filter
};

/// A sequence whose design is the pseudo-time itself (docs/formulation.md 2.3), on elements or on nodes as
/// `support` says. On elements, t_e is the design, and 0 in the start region; its gradient is not defined. On
/// nodes, t_e is the mean over the element's nodes, and grad t is that of the bilinear (trilinear) field at
/// the element's centre. With a filter radius > 0 (length unit), these times are the design smoothed inside
/// the part (RepeatedAveraging). Part, support and region must outlive the sequence. Collective on the grid's
/// communicator.
template <int Dim>
std::unique_ptr<Sequence<Dim>> make_direct_sequence(const Part<Dim>& part, const DesignSupport<Dim>& support,
                                                    const StartRegion& region, double filter_radius = 0.0);

}  // namespace fabseq
