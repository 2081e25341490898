// SPDX-License-Identifier: MIT
/// \file
/// What a sequence asks of the machine, and what it leaves in the part.
#pragma once

#include "fabseq/chain/pipeline.h"
#include "fabseq/report/finding.h"

#include <array>
#include <optional>
#include <vector>

namespace fabseq {

/// Returns between which lengths a layer can be deposited; none without a target.
std::optional<std::array<double, 2>> allowed_thickness(const ModelSettings& settings);

/// Returns by how much each part element fails a check, > 0 where it does; none where the check is not made.
std::optional<std::vector<double>> fault_marks(const BuildFields& fields, const ModelSettings& settings,
                                               Fault fault);

/// The checks of a pseudo-time cut into layers (docs/formulation.md 13.1). `layers`: only time points,
/// sub-parts and the number of layers count. `layer_index`: the layer of each part element, from 1.
/// `with_places`: with the places at which the checks fail. Collective.
template <int Dim>
BuildReport check_layers(const Model<Dim>& model, const PseudoTime<Dim>& time, const LayerDensities& layers,
                         const std::vector<double>& layer_index, bool with_places);

/// The checks of a pipeline's last run, of its binary layers whatever layers it ran with (docs/formulation.md
/// 13.1). Collective.
template <int Dim>
BuildReport check_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                        const StageResults<Dim>& state);

/// The same with the places at which they fail. Collective.
template <int Dim>
BuildReport check_places(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const StageResults<Dim>& state);

/// All findings about a pipeline's last run, with the places. `used_layers`: those with more than a trace of
/// the volume. Collective.
template <int Dim>
BuildReport report_build(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                         const StageResults<Dim>& state, int used_layers);

/// What every evaluation finds, without checks. Collective.
template <int Dim>
BuildReport report_evaluation(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                              const StageResults<Dim>& state);

}  // namespace fabseq
