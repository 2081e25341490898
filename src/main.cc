// SPDX-License-Identifier: MIT
/// \file
/// fabseq: optimizes the fabrication sequence of a part so that it distorts least.
///
///     minimize    sum of weighted terms of the displacement u and the layers' uniformity
///     subject to  bounds on the thickness (or volume) of each layer
///
///     design --Sequence--> pseudo-time --Layers--> densities --Process--> displacements --Responses-->
///     values
///            <-----------------------------------  gradients  <-------------------------------------
///
/// 1 pseudo-time from the design by a heat problem                     (docs/formulation.md 2)
/// 2 layers from the pseudo-time                                       (3)
/// 3 one inherent-strain solve a layer                                 (4)
/// 4 objective and constraints, and their gradients by adjoints        (5 to 8)
/// 5 a new design by the method of moving asymptotes                   (9)
#include "fabseq/base/error.h"
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "fabseq/config/command_line.h"
#include "fabseq/optimize/run_state.h"
#include "fabseq/optimize/stages.h"
#include "fabseq/run/coarse_grid.h"
#include "fabseq/run/restart.h"
#include "fabseq/run/run_output.h"
#include "fabseq/run/tasks.h"
#include "fabseq/sequence/given_sequence.h"

#include <cstdio>

namespace fabseq {
namespace {

template <int Dim>
SequenceReport<Dim> planar_baseline(const Setup<Dim>& setup, const Problem<Dim>& problem, PhaseTimer& timer) {
  Pipeline<Dim> pipeline(setup, make_baseline_sequence(setup), *setup.baseline, setup.config.solver.tolerance,
                         timer);
  const auto state = pipeline.run({}, 0.0, true);
  return report_sequence(setup, problem, pipeline, state);
}

/// Terms that are scaled by their first values are so by those of the initial design, as without a coarse
/// grid.
template <int Dim>
void scale_by_initial_design(const Setup<Dim>& setup, const CommandLine& command_line,
                             Pipeline<Dim>& pipeline, Problem<Dim>& problem) {
  const Design initial = starting_design(setup, pipeline.sequence(), command_line);
  problem.evaluate(pipeline, pipeline.run(initial, setup.layers->traits().first_beta, false));
  pipeline.start_cold();
}

/// Values of the design's binary layers, if the iterate is to be judged by them (docs/formulation.md 9).
template <int Dim>
std::optional<ProblemValues> judge_binary(Pipeline<Dim>& pipeline, RunState<Dim>& run, int iteration) {
  if (!run.continuation.judges_binary(iteration)) return std::nullopt;
  const double beta = run.continuation.beta(iteration);
  return run.problem.evaluate(pipeline, pipeline.run(run.design(), beta, true));
}

template <int Dim>
FinalReports<Dim> final_reports(const Setup<Dim>& setup, const Problem<Dim>& problem, Pipeline<Dim>& pipeline,
                                const BestIterate& best) {
  FinalReports<Dim> reports;
  for (const bool binary : {false, true}) {
    const auto state = pipeline.run(best.design(), best.beta(), binary);
    (binary ? reports.binary : reports.optimized) = report_sequence(setup, problem, pipeline, state);
    reports.interior_minima = count_interior_minima<Dim>(setup.part, state.time.time);
  }
  return reports;
}

template <int Dim>
void optimize(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer);

/// The first iterations, on a grid of half the resolution if the config asks for that; returns the command
/// line of the others, whose -design they come to.
template <int Dim>
CommandLine begin_on_coarse_grid(const CoarseGrid<Dim>& coarse, const CommandLine& command_line,
                                 const Setup<Dim>& setup, RunOutput<Dim>& output) {
  const auto grid_text = [](const Setup<Dim>& of) {
    return to_text<Dim>(of.grid.domain().elements) + " elements";
  };
  print("begins with " + std::to_string(coarse.setup().config.optimizer.max_iterations) + " iterations on " +
        grid_text(coarse.setup()));
  PhaseTimer timer;
  try {
    optimize(coarse.command_line(command_line, output.path()), coarse.setup(), timer);
  } catch (const Stopped& reason) {
    output.end_before_the_first("stopped", reason.what());
    throw;
  } catch (const NumericalError& error) {
    output.end_before_the_first("failed", error.what());
    throw;
  }
  CommandLine others = command_line;
  others.design_file = CoarseGrid<Dim>::refine(setup, output.path());
  print("goes on with " + std::to_string(setup.config.optimizer.max_iterations) + " iterations on " +
        grid_text(setup));
  return others;
}

template <int Dim>
void optimize(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer) {
  const Config& config = setup.config;
  const std::optional<Restart> restart = find_restart(setup, command_line);
  const auto coarse = restart ? std::nullopt : make_coarse_grid(setup, command_line);
  RunOutput<Dim> output(setup, command_line, restart, timer);
  const CommandLine start =
      coarse ? begin_on_coarse_grid(*coarse, command_line, setup, output) : command_line;
  Pipeline<Dim> pipeline(setup, config.solver.tolerance, timer);
  RunState<Dim> run(setup, config.optimizer, pipeline.sequence(),
                    starting_design(setup, pipeline.sequence(), start));
  if (coarse) scale_by_initial_design(setup, command_line, pipeline, run.problem);
  if (restart) {
    run.restore(restart->state);
    pipeline.restore(restart->state);
  }
  try {
    output.keep(run, pipeline);
    output.baseline(planar_baseline(setup, run.problem, timer), pipeline.process().solver_description());
    while (!run.ended()) {
      note_iterations(run.completed());
      stop_if_requested(setup.world());
      const int iteration = run.completed() + 1;
      const double beta = run.continuation.beta(iteration);
      const auto binary = judge_binary(pipeline, run, iteration);
      const auto state = pipeline.run(run.design(), beta, config.projection.binary);
      const Iterate iterate{iteration, beta, run.problem.evaluate(pipeline, state), binary};
      run.best.offer(iterate, run.design());

      const ProblemGradients gradients = run.problem.gradients(pipeline, state, iterate.values);
      Design next = run.design();
      StepReport step;
      {
        const auto scope = timer.enter(Phase::optimizer);
        step = run.optimizer.update(next, gradients, run.continuation.move_limit(iteration));
      }
      output.iteration(iterate, step, pipeline, state, run.design());
      run.complete(std::move(next), step.change, iterate.values);
      if (output.keep(run, pipeline)) pipeline.start_cold();
    }
    output.finish(run.end(), final_reports(setup, run.problem, pipeline, run.best), run.best);
  } catch (const Stopped& reason) {
    output.stop(reason);
    throw;
  } catch (const NumericalError& error) {
    output.fail(error, pipeline);
    throw;
  }
}

template <int Dim>
void run_task(const CommandLine& command_line, const Config& config) {
  PhaseTimer timer;
  const Setup<Dim> setup(PETSC_COMM_WORLD, config);
  // A run for a larger machine can be checked on a small one.
  if (command_line.task != Task::check) setup.require_memory_of_layers();
  switch (command_line.task) {
    case Task::optimize:
      return optimize(command_line, setup, timer);
    case Task::simulate:
      return run_simulate(command_line, setup, timer);
    case Task::evaluate:
      return run_evaluate(command_line, setup, timer);
    case Task::check_gradients:
      return run_check_gradients(command_line, setup, timer);
    case Task::check:
      return run_check(setup);
  }
}

/// What docs/users-guide.md holds between its marks, to the character.
void print_reference() {
  std::string text = reference_table();
  text.pop_back();  // print() ends the line
  print(text);
}

}  // namespace
}  // namespace fabseq

int main(int argc, char** argv) {
  using namespace fabseq;
  CommandLine command_line;
  std::string refusal;
  try {
    command_line = parse_command_line(argc, argv);
  } catch (const Error& error) {
    // Every rank reads the same command line; one of them shall say what is wrong with it.
    command_line.petsc_arguments = {argv[0]};
    refusal = error.what();
  }
  const StopRequests stop_requests(command_line.max_wall_time);
  return run_session(command_line.petsc_arguments, [&] {
    if (!refusal.empty()) throw InputError(refusal);
    if (command_line.help) return print(help_text());
    if (command_line.help_markdown) return print_reference();
    if (command_line.version) return print("fabseq " FABSEQ_VERSION);
    const Config config = read_config(PETSC_COMM_WORLD, command_line);
    return config.dimension == 2 ? run_task<2>(command_line, config) : run_task<3>(command_line, config);
  });
}
