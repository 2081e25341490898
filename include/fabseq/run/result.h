// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/output_directory.h"
#include "fabseq/optimize/best_iterate.h"
#include "fabseq/optimize/pipeline.h"
#include "fabseq/run/sequence_report.h"
#include "fabseq/run/setup.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// The best design's sequence, with the layers it was optimized with and with binary ones; and what it is
/// measured by beside the planar baseline, the binary layers of the design that the config starts from.
template <int Dim>
struct FinalReports {
  SequenceReport<Dim> optimized, binary;
  std::optional<SequenceReport<Dim>> start;  ///< none if its solves failed
  /// Planar, in as many layers as the binary ones that hold anything; none if the baseline has so many or if
  /// its solves failed.
  std::optional<SequenceNumbers> matched;
  std::int64_t interior_minima = 0;
};

/// Fields of the best design, beside those of start and planar baseline: result.h5 and result.xdmf.
/// Collective; throws OutputError on all ranks.
template <int Dim>
void write_result(const Setup<Dim>& setup, const OutputDirectory& directory, const FinalReports<Dim>& reports,
                  const SequenceReport<Dim>& baseline, const BestIterate& best);

/// fields/NAME: density, design, what the pipeline's last run led to, and its checks; `displacement` and
/// `checks` may be empty.
/// Collective; throws OutputError on all ranks.
template <int Dim>
void write_iteration_fields(const Model<Dim>& model, const OutputDirectory& directory,
                            const std::string& name, const Pipeline<Dim>& pipeline,
                            std::span<const double> share, const std::vector<double>& displacement,
                            const BuildFields& checks);

}  // namespace fabseq
