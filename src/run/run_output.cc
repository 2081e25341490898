// SPDX-License-Identifier: MIT
#include "fabseq/run/run_output.h"

#include "fabseq/base/error.h"
#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/files/field_dump.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/run/layer_variable_output.h"
#include "fabseq/sequence/given_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fabseq {

namespace {

Json lists(const std::vector<std::vector<double>>& values) {
  Json result = Json::array();
  for (const auto& list : values) result.push_back(list);
  return result;
}

/// Terms of an objective have one.
std::vector<double> first_components(const std::vector<std::vector<double>>& values) {
  std::vector<double> result;
  for (const auto& value : values) result.push_back(value[0]);
  return result;
}

bool has_functionals(const ProblemValues& values) {
  return std::any_of(values.functionals.begin(), values.functionals.end(),
                     [](const std::vector<double>& list) { return !list.empty(); });
}

}  // namespace

template <int Dim>
RunOutput<Dim>::RunOutput(const Setup<Dim>& setup, const CommandLine& command_line,
                          const std::optional<Restart>& restart, PhaseTimer& timer)
    : setup_(setup),
      timer_(timer),
      directory_(make_output_directory(setup, command_line, restart && restart->in_place)),
      // Each layer group looks for itself: those that are still at work then leave it, too.
      stop_file_(setup.groups.domain(), directory_.file("stop")),
      history_(directory_),
      progress_(setup.world()),
      start_(MPI_Wtime()),
      iteration_start_(start_) {
  if (restart) continue_from(*restart);
}

template <int Dim>
void RunOutput<Dim>::baseline(SequenceReport<Dim> report, const std::string& solver) {
  baseline_ = std::move(report);
  print(solver);
  if (!setup_.group_choice.explanation.empty()) print(setup_.group_choice.explanation);
  char line[160];
  std::snprintf(line, sizeof line, "planar baseline: %d layers, first objective term %.4e",
                setup_.baseline_layers, baseline_.first_objective());
  print(line);
  timer_.reset();
  iteration_start_ = MPI_Wtime();
}

template <int Dim>
void RunOutput<Dim>::iteration(const Iterate& iterate, const StepReport& step, Pipeline<Dim>& pipeline,
                               const PipelineState<Dim>& state, const Design& design) {
  const ProblemValues& values = iterate.values;
  {
    const auto scope = timer_.enter(Phase::output);
    const int every = setup_.config.output.every;
    asked_ = directory_.has(output_request);
    if (asked_ || (every > 0 && iterate.iteration % every == 0))
      dump_fields(iterate.iteration, pipeline, state, design);
  }
  const double now = MPI_Wtime();
  const double total = now - iteration_start_;
  iteration_start_ = now;
  write_history(iterate, step, pipeline, state, design, total);
  for (int phase = 0; phase < phase_count; ++phase) phase_seconds_[phase] += timer_.seconds()[phase];
  timer_.reset();

  ProgressLine line;
  line.iteration = iterate.iteration;
  line.max_iterations = setup_.config.optimizer.max_iterations;
  if (!values.objective.empty() && values.objective[0][0] > 0.0)
    line.objective_ratio = baseline_.first_objective() / values.objective[0][0];
  if (!values.constraints.empty()) line.worst_constraint = values.worst_constraint;
  line.beta = iterate.beta;
  line.seconds = total;
  progress_.print(line);
}

template <int Dim>
void RunOutput<Dim>::write_history(const Iterate& iterate, const StepReport& step,
                                   const Pipeline<Dim>& pipeline, const PipelineState<Dim>& state,
                                   const Design& design, double total) {
  const ProblemValues& values = iterate.values;
  const SolverIterations& solves = pipeline.iterations();
  Json line = Json::object(
      {{"iteration", iterate.iteration},
       {"objective", first_components(values.objective)},
       {"objective_scaled", values.scaled},
       {"constraints", lists(values.constraints)},
       {"worst_constraint", values.worst_constraint},
       {"beta", iterate.beta},
       {"change", step.change},
       {"merit", values.merit},
       {"interior_minima", count_interior_minima<Dim>(setup_.part, state.time.time)},
       {"optimizer", Json::object({{"newton_steps", step.mma.newton_steps},
                                   {"residual", step.mma.kkt_residual},
                                   {"relaxation", step.mma.largest_violation}})},
       {"solver_iterations",
        Json::object({{"primal", solves.primal}, {"adjoint", solves.adjoint}, {"heat", solves.heat}})},
       {"seconds", seconds_record(timer_.seconds(), total)},
       {"peak_memory_bytes", peak_memory_bytes(setup_.world())}});
  if (!state.time.temperature.empty())
    line["temperature_range"] =
        std::vector<double>{state.time.lowest_temperature, state.time.highest_temperature};
  set_layer_variables(line, setup_.layer_variables, design);
  if (has_functionals(values)) line["functionals"] = lists(values.functionals);
  if (iterate.binary)
    line["binary"] = Json::object({{"objective", first_components(iterate.binary->objective)},
                                   {"constraints", lists(iterate.binary->constraints)},
                                   {"worst_constraint", iterate.binary->worst_constraint}});
  history_.append(line);
}

template <int Dim>
void RunOutput<Dim>::dump_fields(int iteration, const Pipeline<Dim>& pipeline,
                                 const PipelineState<Dim>& state, const Design& design) {
  const std::vector<double> time = setup_.part.expand(state.time.time);
  const std::vector<double> layer = setup_.part.expand(pipeline.last_layer_index());
  const std::vector<double> design_field = setup_.design_field(design.field);
  FieldSet<Dim> fields;
  fields.grid = &setup_.grid;
  fields.add_elements("density", setup_.part.density());
  fields.add_elements("time", time);
  fields.add_elements("layer", layer);
  fields.add(setup_.design_support.on_nodes(), "design", design_field);
  if (!state.time.temperature.empty()) fields.add_nodes("temperature", state.time.temperature);
  fields.add_nodes("displacement", state.process.displacement, Dim);
  directory_.make_folder("fields");
  char name[40];
  std::snprintf(name, sizeof name, "fields/iteration_%04d", iteration);
  write_field_dump(setup_.world(), fields, directory_.file(name));
}

template <int Dim>
void RunOutput<Dim>::finish(const RunEnd& end, const FinalReports<Dim>& reports, const BestIterate& best) {
  progress_.finish();
  write_result(reports, best);
  Json record = summary(end);
  record["best_iteration"] = best.iteration();
  record["feasible"] = best.feasible();
  record["beta"] = best.beta();
  record["worst_constraint"] = best.worst_constraint();
  record["optimized"] = reports.optimized.block;
  record["binary"] = reports.binary.block;
  record["baseline"] = baseline_.block;
  record["interior_minima"] = reports.interior_minima;
  set_layer_variables(record, setup_.layer_variables, best.design());
  directory_.write("summary.json", to_text(record, 2) + "\n");
  print_table(reports, record);
}

template <int Dim>
Json RunOutput<Dim>::summary(const RunEnd& end) const {
  Json record = Json::object({{"name", setup_.config.name},
                              {"status", end.status},
                              {"reason", end.reason},
                              {"iterations", end.iterations},
                              {"ranks", size_of(setup_.world())},
                              {"layer_groups", setup_.groups.count()},
                              {"part_elements", setup_.part.count()},
                              {"seconds", seconds_record(phase_seconds_, total_seconds())},
                              {"peak_memory_bytes", peak_memory_bytes(setup_.world())}});
  const int coarse_iterations = setup_.config.optimizer.coarse_iterations;
  if (coarse_iterations > 0) record["coarse_iterations"] = coarse_iterations;
  return record;
}

template <int Dim>
void RunOutput<Dim>::write_result(const FinalReports<Dim>& reports, const BestIterate& best) {
  const std::vector<double> design = setup_.design_field(best.design().field);
  const std::vector<double> substrate = setup_.substrate_field();
  FieldSet<Dim> fields;
  fields.grid = &setup_.grid;
  fields.add_elements("density", setup_.part.density());
  if (setup_.part.substrate().count() > 0) fields.add_elements("substrate", substrate);
  fields.add(setup_.design_support.on_nodes(), "design", design);
  reports.optimized.add_fields(fields, "");
  fields.add_nodes("binary/displacement", reports.binary.displacement, Dim);
  baseline_.add_fields(fields, "planar/");
  Hdf5Writer file(setup_.world(), directory_.file("result.h5"));
  file.template write_fields<Dim>(fields);
  write_layer_variables(file, setup_.layer_variables, "", best.design());
  file.write_attribute("name", setup_.config.name);
  file.write_attribute("iteration", best.iteration());
  file.write_attribute("beta", best.beta());
  file.write_attribute("layers", static_cast<int>(reports.optimized.block.at("layers").size()));
  const std::pair<const char*, const SequenceReport<Dim>*> blocks[] = {
      {"optimized/", &reports.optimized}, {"binary/", &reports.binary}, {"baseline/", &baseline_}};
  for (const auto& [prefix, report] : blocks)
    for (const Json& response : report->block.at("responses"))
      file.write_attribute(prefix + response.at("name").get<std::string>(), response.at("value"));
  file.close();
  directory_.write("result.xdmf", hdf5_xdmf<Dim>(fields, "result.h5"));
}

template <int Dim>
void RunOutput<Dim>::print_table(const FinalReports<Dim>& reports, const Json& summary) const {
  print("");
  print("sequence              first objective   planar / this   max displacement   layers");
  const auto row = [&](const char* name, const SequenceReport<Dim>& report) {
    char line[160];
    std::snprintf(line, sizeof line, "%-20s %16.4e %15.1f %18.4e %8d", name, report.first_objective(),
                  baseline_.first_objective() / report.first_objective(),
                  report.block.at("displacement").at("max").template get<double>(),
                  used_layers(report.block));
    print(line);
  };
  row("planar", baseline_);
  row("optimized", reports.optimized);
  row("optimized, binary", reports.binary);
  char line[160];
  std::snprintf(line, sizeof line, "%s after %d iterations (%s), best feasible: %s, %.1f s; results in %s",
                summary.at("status").get<std::string>().c_str(),
                static_cast<int>(summary.at("iterations").get<std::int64_t>()),
                summary.at("reason").get<std::string>().c_str(),
                summary.at("feasible").get<bool>() ? "yes" : "no",
                summary.at("seconds").at("total").get<double>(), directory_.path().c_str());
  print(line);
}

template class RunOutput<2>;
template class RunOutput<3>;

}  // namespace fabseq
