// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/phase_timer.h"
#include "fabseq/chain/pipeline.h"
#include "fabseq/config/setup.h"
#include "fabseq/report/layer_changes.h"
#include "fabseq/report/sequence_report.h"

#include <memory>
#include <optional>

namespace fabseq {

/// A sequence whose layers have been mended (docs/formulation.md 13.5), simulated again.
template <int Dim>
struct RepairedSequence {
  std::unique_ptr<Pipeline<Dim>> pipeline;  ///< of the mended times
  StageResults<Dim> state;                  ///< of its run in binary layers
  Design design;                            ///< for its runs: it has no field
  SequenceReport binary;
  RepairReport repair;
};

/// Mends the places of a pipeline's last run, which `before` reports, and says so; none where nothing can be
/// mended, and then that run's state stays. Else the pipeline gives back its memory. Collective.
/// \param design  of that run  \param beta  its sharpness
template <int Dim>
std::optional<RepairedSequence<Dim>> repair_sequence(const Setup<Dim>& setup, const Problem<Dim>& problem,
                                                     Pipeline<Dim>& pipeline, const Design& design,
                                                     double beta, const SequenceNumbers& before,
                                                     PhaseTimer& timer);

}  // namespace fabseq
