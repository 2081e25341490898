// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/run/sequence_report.h"

#include <vector>

namespace fabseq {

/// What the scenarios of the strain (docs/formulation.md 4.7) make of a pipeline's last run, for each term of
/// the objective that can be aggregated over them, whichever aggregate it asks for; empty without scenarios.
/// No solve: they are superposed. Collective.
template <int Dim>
std::vector<ScenarioNumbers> report_scenarios(const Model<Dim>& model, const Problem<Dim>& problem,
                                              Pipeline<Dim>& pipeline, const PipelineState<Dim>& state);

}  // namespace fabseq
