// SPDX-License-Identifier: MIT
/// \file
/// What an optimization was for: result.h5 and result.xdmf (docs/reference.md, Output).
#pragma once

#include "fabseq/files/output_directory.h"
#include "fabseq/optimize/best_iterate.h"
#include "fabseq/run/sequence_report.h"
#include "fabseq/run/setup.h"

#include <cstdint>

namespace fabseq {

/// The best design's sequence, with the layers it was optimized with and with binary ones.
template <int Dim>
struct FinalReports {
  SequenceReport<Dim> optimized, binary;
  std::int64_t interior_minima = 0;
};

/// Writes the fields of the best design, beside those of the planar baseline. Collective; throws OutputError
/// on all ranks.
template <int Dim>
void write_result(const Setup<Dim>& setup, const OutputDirectory& directory, const FinalReports<Dim>& reports,
                  const SequenceReport<Dim>& baseline, const BestIterate& best);

}  // namespace fabseq
