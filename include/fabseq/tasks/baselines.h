// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/phase_timer.h"
#include "fabseq/config/setup.h"
#include "fabseq/report/final_reports.h"
#include "fabseq/tasks/bead_checks.h"

#include <vector>

namespace fabseq {

/// Planar layers as the config's `baseline` has them, which all sequences are compared with. Collective.
template <int Dim>
SequenceReport planar_baseline(const Setup<Dim>& setup, const Problem<Dim>& problem, PhaseTimer& timer);

/// The other baselines, in layers as thick as those of an optimized sequence on the average, since thinner
/// layers alone distort less (docs/formulation.md 3.4): planar ones where that makes another number of layers
/// than the planar baseline has, tilted planar ones if the config asks for them, and even ones. One whose
/// solves fail is left out with a warning: the optimized sequence shall not be lost. Collective.
/// `beads`: judges real layers in place of simulated ones; null: it does not.
template <int Dim>
std::vector<Baseline> other_baselines(const Setup<Dim>& setup, const Problem<Dim>& problem,
                                      const SequenceNumbers& optimized, const BeadChecks<Dim>* beads,
                                      PhaseTimer& timer);

}  // namespace fabseq
