// SPDX-License-Identifier: MIT
/// \file
/// A sequence as either deposition model sees it (docs/formulation.md 4.6), whichever it was made for.
#pragma once

#include "fabseq/run/sequence_report.h"

namespace fabseq {

/// What both models make of a pipeline's last run. Collective.
template <int Dim>
BothDepositions report_depositions(const Model<Dim>& model, const Problem<Dim>& problem,
                                   Pipeline<Dim>& pipeline, const PipelineState<Dim>& state);

}  // namespace fabseq
