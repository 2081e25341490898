// SPDX-License-Identifier: MIT
// clang-format off
/// \file
/// fabseq: optimizes the fabrication sequence of a part so that it distorts least.
///
///     minimize    weighted terms of the displacement u, of the layers' uniformity and the like
///     subject to  bounds on the layers, such as their thickness or volume
///
///                    t            rho              u
///     design ---> Sequence ---> Layers ---> Process ---> Responses ---> Problem ---> values
///       ^           (2)          (3)          (4)         (5 to 7)        (9)          |
///       |                                                                              |
///     MMA (9) <--- gradients of all rows <--- adjoints of the same stages (8) <--------+
///
/// Numbers are the sections of docs/formulation.md.
// clang-format on
#include "fabseq/base/error.h"
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "fabseq/config/command_line.h"
#include "fabseq/config/unlikely_numbers.h"
#include "fabseq/output/run_place.h"
#include "fabseq/tasks/optimization.h"
#include "fabseq/tasks/starts.h"
#include "fabseq/tasks/tasks.h"

#include <exception>

namespace fabseq {
namespace {

/// One design after the other, until they converge or there have been as many as were asked for. `begin`: the
/// first of them; none: that of the command line.
template <int Dim>
RunOutcome optimize(const CommandLine& command_line, const Setup<Dim>& setup, const RunPlace& place,
                    std::optional<FirstDesign> begin, PhaseTimer& timer) {
  const std::optional<Restart> restart = find_restart(setup, place);
  const auto coarse = restart ? std::nullopt : make_coarse_grid(setup, command_line);
  const auto starts = restart ? std::nullopt : make_starts(setup, command_line, coarse.has_value());
  if (!restart) require_design(setup, command_line);
  RunOutput<Dim> output(setup, command_line, place, restart, timer);
  // Grid sequencing (9).
  if (coarse) begin = begin_on_coarse_grid<Dim>(*coarse, command_line, setup, place, output, optimize<Dim>);
  if (starts) begin = begin_with_starts<Dim>(*starts, command_line, place, output, optimize<Dim>);
  Pipeline<Dim> pipeline(setup, setup.config.solver.finest_tolerance(), timer);
  RunState<Dim> run = starting_state(setup, command_line, begin, restart, pipeline);
  try {
    output.keep(run, pipeline);
    output.baseline(planar_baseline(setup, run.problem, timer), pipeline.process().description());
    pipeline.set_region(setup.solver.region);
    while (!run.ended()) {
      note_iterations(run.completed());
      stop_if_requested(setup.world());
      const int iteration = run.completed() + 1;
      const double beta = run.continuation.beta(iteration);  // sharpness (3.1)
      pipeline.set_tolerances(run.tolerances());
      const auto binary = judge_binary(setup, pipeline, run, iteration);  // (9)
      // Pseudo-time (2), layers (3), displacements (4).
      const auto state = pipeline.run(run.design(), beta, setup.config.projection.binary);
      // Objective and constraints (5 to 7), scaled (9).
      const Iterate iterate{iteration, beta, run.problem.evaluate(pipeline, state), binary};
      run.best.offer(iterate, run.design());
      // Adjoints through all stages (8).
      ProblemGradients gradients = run.problem.gradients(pipeline, state, iterate.values);
      // A step of the method of moving asymptotes (9).
      Design next = run.design();
      const StepReport step = [&] {
        const auto scope = timer.enter(Phase::optimizer);
        return run.optimizer.update(next, std::move(gradients), run.continuation.move_limit(iteration));
      }();
      output.iteration(iterate, step, pipeline, state, run.design());
      adapt_limits(setup, run, pipeline, state, iterate);  // to what the exact checks say (13.2)
      run.complete(std::move(next), step.change, iterate.values);
      if (output.keep(run, pipeline)) pipeline.start_cold();
    }
    pipeline.set_tolerances(Tolerances::all(setup.config.solver.tolerance_of_reports()));
    pipeline.set_region(SolverRegion::whole);
    return finish(setup, run, pipeline, output, timer);
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
  stop_if_signalled(setup.world());
  for (const std::string& line : unlikely_numbers(config, PartFigures(setup))) warn(line);
  if (command_line.task != Task::check) {
    setup.require_walls();
    setup.require_memory_of_layers();  // a run for a larger machine can be checked on a small one
    if (command_line.task == Task::optimize) setup.require_address_space();
  }
  switch (command_line.task) {
    case Task::optimize:
      (void)optimize(command_line, setup, place_of_run(config, command_line), std::nullopt, timer);
      return;
    case Task::simulate:
      return run_simulate(command_line, setup, timer);
    case Task::sensitivity:
      return run_sensitivity(command_line, setup, timer);
    case Task::evaluate:
      return run_evaluate(command_line, setup, timer);
    case Task::check_gradients:
      return run_check_gradients(command_line, setup, timer);
    case Task::check:
      run_check(setup);
      if (command_line.picture) write_check_picture(setup, command_line);
      return setup.require_walls();  // last: the picture shows where they are thin
    case Task::surface:
    case Task::machine:
      break;  // need no setup
  }
}

}  // namespace
}  // namespace fabseq

int main(int argc, char** argv) {
  using namespace fabseq;
  CommandLine command_line;
  std::exception_ptr problem;
  try {
    command_line = parse_command_line(argc, argv);
  } catch (...) {
    // Thrown again in the session, where one rank says what is wrong with the command line of all.
    command_line.petsc_arguments = {argv[0]};
    problem = std::current_exception();
  }
  const StopRequests stop_requests(command_line.max_wall_time);
  return run_session(command_line.petsc_arguments, [&] {
    if (problem) std::rethrow_exception(problem);
    refuse_own_options_of_petsc();
    if (command_line.help) return print(help_text());
    if (command_line.help_markdown) return print(reference_table());
    if (command_line.version) return print("fabseq " FABSEQ_VERSION);
    if (command_line.task == Task::surface) return write_surface(PETSC_COMM_WORLD, command_line);
    if (command_line.task == Task::machine)
      return print(to_text(config_with_machine(PETSC_COMM_WORLD, command_line), 2));
    const Config config = read_config(PETSC_COMM_WORLD, command_line);
    stop_if_signalled(PETSC_COMM_WORLD);
    return config.dimension() == 2 ? run_task<2>(command_line, config) : run_task<3>(command_line, config);
  });
}
