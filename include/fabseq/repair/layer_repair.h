// SPDX-License-Identifier: MIT
/// \file
/// The last step of a run: what is left at few places is mended in the binary layers (docs/formulation.md
/// 13.5).
#pragma once

#include "fabseq/model/model.h"
#include "fabseq/report/layer_changes.h"
#include "fabseq/sequence/sequence.h"

#include <optional>
#include <span>

namespace fabseq {

/// A pseudo-time with mended layers.
template <int Dim>
struct RepairedTime {
  PseudoTime<Dim> time;
  LayerChanges changes;
};

/// Mends the places at which binary layers of a pseudo-time fail the checks of docs/formulation.md 13.1.
/// Takes no elastic solve. None if nothing fails, if more than `most_share` of the part does or would have to
/// go to another layer, if fewer elements do not fail afterwards, or if more fail one of the checks; and for
/// multi-planar layers, which have no times to change. Collective on the grid's communicator, with the same
/// result on all copies of a rank.
/// \param layer_variables  of the design that the time belongs to
template <int Dim>
std::optional<RepairedTime<Dim>> repair_layers(const Model<Dim>& model, const PseudoTime<Dim>& time,
                                               std::span<const double> layer_variables, double most_share);

}  // namespace fabseq
