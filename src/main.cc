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
#include "fabseq/io/command_line.h"
#include "fabseq/optimize/best_iterate.h"
#include "fabseq/optimize/continuation.h"
#include "fabseq/optimize/run_output.h"
#include "fabseq/optimize/tasks.h"
#include "fabseq/sequence/given_sequence.h"

#include <cstdio>

namespace fabseq {
namespace {

template <int Dim>
SequenceReport<Dim> planar_baseline(const Setup<Dim>& setup, const Problem<Dim>& problem, PhaseTimer& timer) {
  Pipeline<Dim> pipeline(setup, make_baseline_sequence(setup), setup.config.solver.tolerance, timer);
  const auto state = pipeline.run({}, setup.baseline_layers, 0.0, true);
  return report_sequence(setup, problem, pipeline, state);
}

template <int Dim>
FinalReports<Dim> final_reports(const Setup<Dim>& setup, const Problem<Dim>& problem, Pipeline<Dim>& pipeline,
                                const BestIterate& best) {
  FinalReports<Dim> reports;
  for (const bool binary : {false, true}) {
    const auto state = pipeline.run(best.design(), setup.layer_count, best.beta(), binary);
    (binary ? reports.binary : reports.optimized) = report_sequence(setup, problem, pipeline, state);
    reports.interior_minima = count_interior_minima<Dim>(setup.part, state.time.time);
  }
  return reports;
}

template <int Dim>
void optimize(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer) {
  const Config& config = setup.config;
  Pipeline<Dim> pipeline(setup, make_sequence(setup, config.solver.tolerance), config.solver.tolerance,
                         timer);
  Problem<Dim> problem(setup);
  const Continuation continuation(config.projection, setup.first_beta(), setup.last_beta(), config.optimizer);
  std::vector<double> design = starting_design(setup, pipeline.sequence(), command_line);
  DesignUpdate optimizer(setup.world(), pipeline.sequence().space(), design.size(), config.optimizer);
  BestIterate best;
  RunOutput<Dim> output(setup, command_line, timer);
  RunEnd end{"iteration_limit", "max_iterations reached", 0};
  int iteration = 1;
  try {
    output.baseline(planar_baseline(setup, problem, timer), pipeline.process().solver_description());
    for (; iteration <= config.optimizer.max_iterations; ++iteration) {
      const double beta = continuation.beta(iteration);
      const auto state = pipeline.run(design, setup.layer_count, beta, config.projection.binary);
      const ProblemValues values = problem.evaluate(pipeline, state);
      best.offer(iteration, beta, values, design);

      const ProblemGradients gradients = problem.gradients(pipeline, state, values);
      std::vector<double> next = design;
      StepReport step;
      {
        const auto scope = timer.enter(Phase::optimizer);
        step = optimizer.update(next, gradients, continuation.move_limit(iteration));
      }
      output.iteration(iteration, beta, values, step, pipeline, state, design);
      design = std::move(next);
      end.iterations = iteration;
      if (step.change < config.optimizer.change_tolerance && continuation.at_last_beta(iteration)) {
        end = {"converged", "the design's change fell below change_tolerance", iteration};
        break;
      }
    }
    output.finish(end, final_reports(setup, problem, pipeline, best), best);
  } catch (const NumericalError& error) {
    output.fail({"failed", error.what(), end.iterations}, continuation.beta(iteration), design);
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
  return run_session(command_line.petsc_arguments, [&] {
    if (!refusal.empty()) throw InputError(refusal);
    if (command_line.help) return print(help_text());
    if (command_line.help_markdown) return print_reference();
    if (command_line.version) return print("fabseq " FABSEQ_VERSION);
    const Config config = read_config(PETSC_COMM_WORLD, command_line);
    return config.dimension == 2 ? run_task<2>(command_line, config) : run_task<3>(command_line, config);
  });
}
