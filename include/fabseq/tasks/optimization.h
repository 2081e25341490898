// SPDX-License-Identifier: MIT
/// \file
/// What an optimization does beside its iterations, which are in src/main.cc.
#pragma once

#include "fabseq/output/run_output.h"
#include "fabseq/tasks/baselines.h"
#include "fabseq/tasks/coarse_grid.h"

#include <functional>
#include <optional>

namespace fabseq {

/// An optimization on its own, such as that on the coarse grid.
template <int Dim>
using Optimize = std::function<void(const CommandLine&, const Setup<Dim>&, PhaseTimer&)>;

/// Runs what comes before the first iteration of a run: what ends it ends the run, which still leaves a
/// summary.
template <int Dim>
void before_the_first(RunOutput<Dim>& output, const std::function<void()>& run);
/// The first iterations, on a grid of half the resolution if there is a coarse grid; returns the command line
/// of the others, whose -design they come to.
template <int Dim>
CommandLine begin_on_coarse_grid(const std::optional<CoarseGrid<Dim>>& coarse,
                                 const CommandLine& command_line, const Setup<Dim>& setup,
                                 RunOutput<Dim>& output, const Optimize<Dim>& optimize);
/// The state before the first iteration, or, with `restart`, between two of them. Terms that are scaled by
/// their first values are scaled by those of the initial design, also after iterations on a coarse grid.
template <int Dim>
RunState<Dim> starting_state(const Setup<Dim>& setup, const CommandLine& command_line,
                             const CommandLine& after_coarse_grid, const std::optional<Restart>& restart,
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
void finish(const Setup<Dim>& setup, const RunState<Dim>& run, Pipeline<Dim>& pipeline,
            RunOutput<Dim>& output, PhaseTimer& timer);

}  // namespace fabseq
