// SPDX-License-Identifier: MIT
/// \file
/// Fields of single iterations: fields/iteration_NNNN (docs/reference.md, Output).
#pragma once

#include "fabseq/files/output_directory.h"
#include "fabseq/optimize/pipeline.h"

#include <span>

namespace fabseq {

/// Writes what an iteration evaluated. Collective; throws OutputError on all ranks.
template <int Dim>
void dump_iteration(const Model<Dim>& model, const OutputDirectory& directory, int iteration,
                    const Pipeline<Dim>& pipeline, const PipelineState<Dim>& state, const Design& design);
/// Writes the design of an iteration that failed, and the pseudo-time and layers it led to, if it got there.
/// `share`: of the design's field.
template <int Dim>
void dump_failed_iteration(const Model<Dim>& model, const OutputDirectory& directory, int iteration,
                           const Pipeline<Dim>& pipeline, std::span<const double> share);

}  // namespace fabseq
