// SPDX-License-Identifier: MIT
#include "fabseq/tasks/optimization.h"

#include "fabseq/base/session.h"
#include "fabseq/chain/stages.h"
#include "fabseq/machine/interior_extrema.h"
#include "fabseq/tasks/starting_design.h"
#include "fabseq/tasks/tasks.h"
#include "tasks/lumping.h"
#include "tasks/repaired_sequence.h"
#include "tasks/sensitivity.h"
#include "tasks/write_real_layers.h"

#include <utility>

namespace fabseq {

namespace {

template <int Dim>
std::string iterations_on(const Setup<Dim>& setup) {
  return std::to_string(setup.config.optimizer.max_iterations) + " iterations on " +
         to_text<Dim>(setup.grid.domain().elements) + " elements";
}

/// Binary layers of the design that the config starts from, whatever file this run starts from. The optimized
/// sequence shall not be lost because these solves fail.
template <int Dim>
std::optional<SequenceReport> start_report(const Setup<Dim>& setup, const Problem<Dim>& problem,
                                           Pipeline<Dim>& pipeline, double beta,
                                           const BeadChecks<Dim>* beads) {
  const Design start = starting_design(setup, pipeline.sequence(), CommandLine());
  try {
    const auto state = pipeline.run(start, beta, true);
    SequenceReport report = report_sequence(setup, problem, pipeline, state);
    if (beads) beads->judge(*state.time, start.layer_variables, report);
    return report;
  } catch (const NumericalError& error) {
    warn(std::string("no block start in summary.json: ") + error.what());
    return std::nullopt;
  }
}

/// Leaves what result.h5 has of binary layers, as reports take memory: displacements and stress.
void drop_unwritten_fields(SequenceReport& binary) {
  binary.time = binary.time_gradient = binary.layer = binary.temperature = binary.nodal_time = {};
  binary.build_fields.keep_binary();
}

/// Returns the worst miss by the layers that the best iterate was judged by.
template <int Dim>
std::optional<ConstraintMiss> miss_of_best(const Setup<Dim>& setup, const Problem<Dim>& problem,
                                           const FinalReports& reports, const BestIterate& best) {
  std::optional<ConstraintMiss> smooth = worst_miss(setup, problem, reports.optimized.values);
  if (!best.by_binary()) return smooth;
  std::optional<ConstraintMiss> binary = worst_miss(setup, problem, reports.binary.values);
  return !smooth || (binary && binary->violation > smooth->violation) ? binary : smooth;
}

/// What the best design comes to, the one that the config starts from, at the same sharpness, and the
/// baselines. With `beads`, `real` becomes the best design's real layers.
template <int Dim>
FinalReports final_reports(const Setup<Dim>& setup, const Problem<Dim>& problem, Pipeline<Dim>& pipeline,
                           const BestIterate& best, const BeadChecks<Dim>* beads,
                           std::optional<RealSequence<Dim>>& real, PhaseTimer& timer) {
  FinalReports reports;
  const auto state = pipeline.run(best.design(), best.beta(), true);
  reports.interior_minima = count_interior_minima<Dim>(setup.part, state.time->time);
  reports.binary = report_sequence(setup, problem, pipeline, state);
  auto repaired =
      setup.config.optimizer.repair_iterations > 0
          ? repair_sequence(setup, problem, pipeline, best.design(), best.beta(), reports.binary, timer)
          : std::nullopt;
  if (repaired) {
    reports.binary = std::move(repaired->binary);
    reports.repair = std::move(repaired->repair);
  }
  Pipeline<Dim>& last = repaired ? *repaired->pipeline : pipeline;
  GivenDesign<Dim> given;
  if (beads) {
    given = {*last.last_time(), best.design().layer_variables, best.beta()};
    RealSequence<Dim> judged = beads->judge(given.time, given.layer_variables, reports.binary);
    real = beads->on_grid_for_bodies(std::move(judged), given.time, given.layer_variables);
  }
  drop_unwritten_fields(reports.binary);
  // Reports take memory. Planar layers, which need a pipeline of their own, come while there are few, and not
  // beside another pipeline's solvers.
  last.release_memory();
  reports.baselines = other_baselines(setup, problem, reports.binary, beads, timer);
  reports.optimized =
      report_sequence(setup, problem, last,
                      last.run(repaired ? repaired->design : best.design(), best.beta(), /*binary=*/false));
  reports.optimized.strain = strain_when_built(last);
  last.release_memory();
  reports.start = start_report(setup, problem, pipeline, best.beta(), beads);
  if (beads) {
    pipeline.release_memory();
    reports.binary.real_layers->lumping = simulate_lumping(setup, given, timer);
  }
  reports.limits = constraint_limits(setup, problem);
  reports.miss = miss_of_best(setup, problem, reports, best);
  return reports;
}

/// What the best design comes to, as summary.json has it.
RunOutcome outcome_of(const FinalReports& reports, const BestIterate& best, const Json& starts) {
  RunOutcome result{best.design(), {},           best.feasible(), best.worst_constraint(),
                    best.merit(),  reports.miss, starts};
  for (const NamedValue& response : reports.optimized.responses)
    if (response.name.starts_with("objective")) result.objective.push_back(response.value);
  return result;
}

template <int Dim>
void write_sensitivity_if_possible(const Setup<Dim>& setup, Sequence<Dim>& sequence, const BestIterate& best,
                                   const OutputDirectory& directory, PhaseTimer& timer) {
  try {
    write_sensitivity(setup, sequence, best.design(), best.beta(), directory, timer);
  } catch (const Stopped& reason) {
    warn(std::string("no sensitivity table: ") + reason.what());
  } catch (const NumericalError& error) {
    warn(std::string("no sensitivity table: ") + error.what());
  }
}

}  // namespace

template <int Dim>
void before_the_first(RunOutput<Dim>& output, const std::function<void()>& run) {
  try {
    run();
  } catch (const Stopped& reason) {
    output.end_before_the_first("stopped", reason.what());
    throw;
  } catch (const NumericalError& error) {
    output.end_before_the_first("failed", error.what());
    throw;
  }
}

template <int Dim>
FirstDesign begin_on_coarse_grid(const CoarseGrid<Dim>& coarse, const CommandLine& command_line,
                                 const Setup<Dim>& setup, const RunPlace& place, RunOutput<Dim>& output,
                                 const Optimize<Dim>& optimize) {
  print("begins with " + iterations_on(coarse.setup()));
  PhaseTimer timer;
  const RunPlace first = place.inside(coarse_folder);
  RunOutcome outcome;
  before_the_first<Dim>(
      output, [&] { outcome = optimize(command_line, coarse.setup(), first, std::nullopt, timer); });
  output.set_starts(outcome.starts);
  FirstDesign refined = coarse.refine(setup, outcome.design, first.directory);
  print("goes on with " + iterations_on(setup));
  return refined;
}

template <int Dim>
RunState<Dim> starting_state(const Setup<Dim>& setup, const CommandLine& command_line,
                             const std::optional<FirstDesign>& begin, const std::optional<Restart>& restart,
                             Pipeline<Dim>& pipeline) {
  const Sequence<Dim>& sequence = pipeline.sequence();
  if (begin) require_within_bounds(setup, sequence, *begin);
  RunState<Dim> run(setup, setup.config.optimizer, sequence,
                    begin ? begin->design : starting_design(setup, sequence, command_line));
  if (begin && !restart) {
    const Design initial = starting_design(setup, sequence, command_line);
    run.problem.evaluate(pipeline, pipeline.run(initial, setup.layers->traits().first_beta, false));
    pipeline.start_cold();
  }
  if (restart) {
    run.restore(restart->state);
    pipeline.restore(restart->state);
  }
  return run;
}

template <int Dim>
void require_design(const Setup<Dim>& setup, const CommandLine& command_line) {
  if (!command_line.design_file) return;
  (void)starting_design(setup, *make_sequence<Dim>(setup, setup.config.solver.finest_tolerance()),
                        command_line);
}

template <int Dim>
std::optional<JudgedValues> judge_binary(const Setup<Dim>& setup, Pipeline<Dim>& pipeline, RunState<Dim>& run,
                                         int iteration) {
  if (!run.continuation.judges_binary(iteration)) return std::nullopt;
  const double beta = run.continuation.beta(iteration);
  const Tolerances usual = pipeline.tolerances();
  pipeline.set_tolerances(Tolerances::all(usual.judged));
  const auto state = pipeline.run(run.design(), beta, true);
  JudgedValues values{run.problem.evaluate(pipeline, state), std::nullopt};
  values.beyond_limits = beyond_limits(setup, run.problem, pipeline, state, /*with_places=*/true);
  pipeline.set_tolerances(usual);
  return values;
}

template <int Dim>
void adapt_limits(const Setup<Dim>& setup, RunState<Dim>& run, const Pipeline<Dim>& pipeline,
                  const StageResults<Dim>& state, const Iterate& iterate) {
  if (!run.problem.adapts()) return;
  const std::optional<BeyondLimits> beyond =
      iterate.binary ? iterate.binary->beyond_limits
                     : beyond_limits(setup, run.problem, pipeline, state, /*with_places=*/false);
  // Iterates that are judged are no longer led to where the checks begin to fail.
  if (beyond) run.problem.adapt(iterate.values, beyond->shares, !iterate.binary);
}

template <int Dim>
RunOutcome finish(const Setup<Dim>& setup, const RunState<Dim>& run, Pipeline<Dim>& pipeline,
                  RunOutput<Dim>& output, PhaseTimer& timer) {
  const BestIterate& best = run.best;
  const auto beads = make_bead_checks(setup);
  std::optional<RealSequence<Dim>> real;
  const FinalReports reports = final_reports(setup, run.problem, pipeline, best, beads.get(), real, timer);
  if (real) write_real_layers(*beads, *real, reports.binary, output.directory());
  output.finish(run.end(), reports, best);
  if (setup.config.output.stress) print_words(reports.binary, "stress");
  for (const std::string& line : reports.binary.found.doubts()) warn(line);
  if (setup.config.output.sensitivity)
    write_sensitivity_if_possible(setup, pipeline.sequence(), best, output.directory(), timer);
  return outcome_of(reports, best, output.starts());
}

FABSEQ_INSTANTIATE_FUNCTION(before_the_first);
FABSEQ_INSTANTIATE_FUNCTION(begin_on_coarse_grid);
FABSEQ_INSTANTIATE_FUNCTION(starting_state);
FABSEQ_INSTANTIATE_FUNCTION(require_design);
FABSEQ_INSTANTIATE_FUNCTION(judge_binary);
FABSEQ_INSTANTIATE_FUNCTION(adapt_limits);
FABSEQ_INSTANTIATE_FUNCTION(finish);

}  // namespace fabseq
