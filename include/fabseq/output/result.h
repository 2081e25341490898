// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/chain/pipeline.h"
#include "fabseq/config/setup.h"
#include "fabseq/files/output_directory.h"
#include "fabseq/optimize/best_iterate.h"
#include "fabseq/report/final_reports.h"

#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// Fields of the best design, beside those of start and planar baseline: result.h5 and result.xdmf.
/// Collective; throws OutputError on all ranks.
template <int Dim>
void write_result(const Setup<Dim>& setup, const OutputDirectory& directory, const FinalReports& reports,
                  const SequenceReport& baseline, const BestIterate& best);

/// The iteration that fields belong to; `failed`: the one in which a solver did.
struct DumpedIteration {
  int iteration;
  bool failed = false;
};

/// fields/iteration_NNNN or iteration_NNNN_failed: density, design, what the pipeline's last run led to, and
/// its checks; `displacement` and `checks` may be empty. The number is the time of a film in ParaView.
/// Collective; throws OutputError on all ranks.
template <int Dim>
void write_iteration_fields(const Model<Dim>& model, const OutputDirectory& directory,
                            const DumpedIteration& dumped, const Pipeline<Dim>& pipeline,
                            std::span<const double> share, const std::vector<double>& displacement,
                            const BuildFields& checks);

}  // namespace fabseq
