// SPDX-License-Identifier: MIT
/// \file
/// What an optimization does beside its iterations, which are in src/main.cc.
#pragma once

#include "fabseq/output/run_output.h"
#include "fabseq/tasks/baselines.h"
#include "fabseq/tasks/coarse_grid.h"
#include "fabseq/tasks/run_outcome.h"
#include "fabseq/tasks/starting_design.h"

#include <functional>
#include <optional>

namespace fabseq {

/// An optimization on its own, such as that on the coarse grid, at a place of its own; it may be given the
/// design to begin with.
template <int Dim>
using Optimize = std::function<RunOutcome(const CommandLine&, const Setup<Dim>&, const RunPlace&,
                                          std::optional<FirstDesign>, PhaseTimer&)>;

/// Runs what comes before the first iteration of a run: what ends it ends the run, which still leaves a
/// summary.
template <int Dim>
void before_the_first(RunOutput<Dim>& output, const std::function<void()>& run);
/// The first iterations, on a grid of half the resolution, of a run at `place`; returns the design that the
/// others begin with.
template <int Dim>
FirstDesign begin_on_coarse_grid(const CoarseGrid<Dim>& coarse, const CommandLine& command_line,
                                 const Setup<Dim>& setup, const RunPlace& place, RunOutput<Dim>& output,
                                 const Optimize<Dim>& optimize);
/// The state before the first iteration, or, with `restart`, between two of them. Terms that are scaled by
/// their first values are scaled by those of the command line's design, also where the run begins with
/// another. Throws InputError if that one leaves the bounds.
template <int Dim>
RunState<Dim> starting_state(const Setup<Dim>& setup, const CommandLine& command_line,
                             const std::optional<FirstDesign>& begin, const std::optional<Restart>& restart,
                             Pipeline<Dim>& pipeline);

/// Reads the file of -design, if there is one, and forgets it: what is wrong with it is said before a run
/// that is to be replaced is touched. Throws InputError.
template <int Dim>
void require_design(const Setup<Dim>& setup, const CommandLine& command_line);

/// Values of the design's binary layers, if the iterate is to be judged by them (docs/formulation.md 9).
template <int Dim>
std::optional<JudgedValues> judge_binary(const Setup<Dim>& setup, Pipeline<Dim>& pipeline, RunState<Dim>& run,
                                         int iteration);
/// Adapts the limits that the config leaves open to what the exact checks find at an iterate's state, for the
/// next one (docs/developer/repair.md 13.2). Collective.
template <int Dim>
void adapt_limits(const Setup<Dim>& setup, RunState<Dim>& run, const Pipeline<Dim>& pipeline,
                  const StageResults<Dim>& state, const Iterate& iterate);

/// The results of a run that was not interrupted, and its sensitivity table, if that is asked for. What keeps
/// the table from being made is a warning: the results are there.
template <int Dim>
RunOutcome finish(const Setup<Dim>& setup, const RunState<Dim>& run, Pipeline<Dim>& pipeline,
                  RunOutput<Dim>& output, PhaseTimer& timer);

}  // namespace fabseq
