// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "fabseq/chain/stages.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/output/model_group.h"
#include "fabseq/output/records.h"
#include "fabseq/output/run_clock.h"
#include "fabseq/output/summary_table.h"
#include "fabseq/output/task_directory.h"
#include "fabseq/output/terminal.h"
#include "fabseq/process/residual_stress.h"
#include "fabseq/report/sequence_report.h"
#include "fabseq/tasks/starting_design.h"
#include "fabseq/tasks/tasks.h"
#include "tasks/repaired_sequence.h"
#include "tasks/write_real_layers.h"

#include <cmath>
#include <optional>
#include <utility>

namespace fabseq {

namespace {

/// sqrt of the sum over all nodes of |increment|^2, one per layer.
template <int Dim>
std::vector<double> increment_norms(const Process<Dim>& process, int layers, MPI_Comm comm) {
  std::vector<double> norms(layers, 0.0);
  for (int j = 0; j < layers; ++j)
    for (const double u : process.layer_increment(j, true)) norms[j] += u * u;
  sum_in_place(comm, norms);
  for (double& norm : norms) norm = std::sqrt(norm);
  return norms;
}

/// Displacement after every layer, as stages/displacement.
template <int Dim>
void write_stages(Hdf5Writer& file, const Setup<Dim>& setup, const Process<Dim>& process, int layers) {
  std::vector<double> displacement(static_cast<std::size_t>(setup.grid.owned_nodes().count()) * Dim, 0.0);
  for (int j = 0; j < layers; ++j) {
    const std::vector<double> increment = process.layer_increment(j, true);
    for (std::size_t i = 0; i < displacement.size(); ++i) displacement[i] += increment[i];
    file.template write_stage<Dim>(setup.grid, {"stages/displacement", true, Dim, displacement, true}, j,
                                   layers);
  }
}

/// Residual stress, before or after the release.
template <int Dim>
struct Stress {
  LockedIn found;
  StressExtremes<Dim> extremes;

  Stress(const Part<Dim>& part, LockedIn found_)
      : found(std::move(found_)), extremes(stress_extremes(part, found.stress)) {}
};

/// What a simulation found out.
template <int Dim>
struct Simulation {
  SequenceReport report;
  Stress<Dim> stress;
  std::vector<double> increment_norms;  ///< of each layer
  std::optional<Stress<Dim>> released = std::nullopt;
  Design design = {};
  std::optional<RepairReport> repair = std::nullopt;

  const FinishedShape& shape() const { return *report.finished; }
};

/// What the last run of a pipeline comes to.
template <int Dim>
Simulation<Dim> simulation_of(const Setup<Dim>& setup, Pipeline<Dim>& pipeline,
                              const StageResults<Dim>& state, SequenceReport report) {
  const Process<Dim>& process = pipeline.process();
  Simulation<Dim> result{std::move(report),
                         {setup.part, process.locked_in(*state.densities)},
                         increment_norms(process, state.densities->count(), setup.grid.comm())};
  result.report.strain = strain_when_built(pipeline);
  const FinishedShape& shape = result.shape();
  if (shape.released)
    result.released = Stress<Dim>(
        setup.part, process.released(result.stress.found, process.model().on_all_nodes(shape.release)));
  else if (shape.failure.empty())
    warn("no release_displacement: " +
         release_obstacle(setup.grid, setup.supports, setup.config.process.void_model));
  return result;
}

/// result.h5 and result.xdmf.
template <int Dim>
void write_fields(const Setup<Dim>& setup, const OutputDirectory& directory, Pipeline<Dim>& pipeline,
                  const Simulation<Dim>& simulation) {
  const bool has_design = pipeline.sequence().has_design();
  const std::vector<double> design =
      has_design ? setup.design_field(simulation.design.field) : std::vector<double>();
  const std::vector<double> substrate = setup.substrate_field();
  const auto& released = simulation.released;
  FieldSet<Dim> fields{&setup.grid, {}};
  fields.add_elements("density", setup.part.density());
  if (setup.part.substrate().count() > 0) fields.add_elements("substrate", substrate);
  if (has_design)
    fields.add(setup.design_support.on_nodes(), "design", design, setup.design_support.components());
  add_sequence_fields(fields, setup.part, simulation.report, "");
  const LockedIn& built = simulation.stress.found;
  fields.add_elements("residual_stress", built.stress, voigt_size<Dim>);
  if (!built.plastic_strain.empty()) fields.add_elements("plastic_strain", built.plastic_strain);
  if (released) fields.add_elements("released_stress", released->found.stress, voigt_size<Dim>);
  if (released && !released->found.plastic_strain.empty())
    fields.add_elements("released_plastic_strain", released->found.plastic_strain);
  Hdf5Writer file(setup.world(), directory.file("result.h5"));
  file.template write_fields<Dim>(fields);
  write_layer_variables(file, setup.layers->variables(), "", simulation.design);
  write_model_group<Dim>(file, setup, simulation.report.strain);
  file.write_array("layer_displacement_norms", simulation.increment_norms);
  if (setup.config.output.stages)
    write_stages(file, setup, pipeline.process(), static_cast<int>(simulation.increment_norms.size()));
  file.write_attribute("name", setup.config.name);
  for (const NamedValue& response : simulation.report.responses)
    file.write_attribute(response.name, response.value);
  file.close();
  directory.write("result.xdmf", hdf5_xdmf<Dim>(fields, "result.h5"));
}

template <int Dim>
Json to_record(const StressExtremes<Dim>& extremes) {
  return Json::object({{"von_mises", extremes.von_mises},
                       {"lowest", std::vector<double>(extremes.lowest.begin(), extremes.lowest.end())},
                       {"highest", std::vector<double>(extremes.highest.begin(), extremes.highest.end())}});
}

/// summary.json.
template <int Dim>
Json to_record(const Setup<Dim>& setup, const Simulation<Dim>& simulation, const Seconds& seconds) {
  const std::string& failure = simulation.shape().failure;
  const bool failed = !failure.empty();
  Json record = Json::object({{"name", setup.config.name},
                              {"status", failed ? "failed" : "converged"},
                              {"reason", failed ? failure : "simulated"}});
  add_members(record, simulation.report, setup.settings);
  if (simulation.repair) record["repair"] = to_record(*simulation.repair);
  set_layer_variables(record, setup.layers->variables(), simulation.design);
  record["layer_displacement_norms"] = simulation.increment_norms;
  record["residual_stress"] = to_record(simulation.stress.extremes);
  if (const auto& released = simulation.released)
    record["released"] = Json::object({{"displacement", to_record(simulation.shape().released->part)},
                                       {"residual_stress", to_record(released->extremes)}});
  record["seconds"] = seconds_record(seconds);
  record["peak_memory_bytes"] = peak_memory_bytes(setup.world());
  return record;
}

template <int Dim>
void print_stress(const Simulation<Dim>& simulation) {
  std::string line = formatted("largest equivalent stress %.4g", simulation.stress.extremes.von_mises);
  if (const auto& released = simulation.released)
    line += formatted(", after the release %.4g", released->extremes.von_mises);
  print(line);
  print_words(simulation.report, "stress");
}

template <int Dim>
void print_numbers(const Setup<Dim>& setup, const Simulation<Dim>& simulation) {
  for (const std::string& row : simulation_table(simulation.report, setup.settings)) print(row);
  print_responses(simulation.report);
  if (setup.config.output.stress) print_stress(simulation);
  for (const std::string& line : simulation.report.found.doubts()) warn(line);
}

}  // namespace

template <int Dim>
void run_simulate(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer) {
  const double start = MPI_Wtime();
  Pipeline<Dim> pipeline(setup, setup.config.solver.finest_tolerance(), timer);
  const Problem<Dim> problem(setup, setup.config.optimizer.constraint_margin);
  const Design design = starting_design(setup, pipeline.sequence(), command_line);
  const OutputDirectory directory = make_output_directory(setup, command_line);
  const StopFile stop_file(setup.groups.domain(), directory.file("stop"));

  const double beta = setup.layers->traits().first_beta;
  const auto state = pipeline.run(design, beta, setup.binary());
  SequenceReport report = report_sequence(setup, problem, pipeline, state);
  auto repaired = command_line.repair ? repair_sequence(setup, problem, pipeline, design, beta, report, timer)
                                      : std::nullopt;
  if (repaired) report = std::move(repaired->binary);
  Pipeline<Dim>& last = repaired ? *repaired->pipeline : pipeline;
  Simulation<Dim> simulation =
      simulation_of(setup, last, repaired ? repaired->state : state, std::move(report));
  simulation.design = repaired ? repaired->design : design;
  if (const auto beads = make_bead_checks(setup)) {
    const PseudoTime<Dim>& time = *last.last_time();
    RealSequence<Dim> judged = beads->judge(time, design.layer_variables, simulation.report);
    const RealSequence<Dim> real = beads->on_grid_for_bodies(std::move(judged), time, design.layer_variables);
    write_real_layers(*beads, real, simulation.report, directory);
  }
  if (repaired) simulation.repair = std::move(repaired->repair);

  write_fields(setup, directory, last, simulation);
  Json record = to_record(setup, simulation, {timer.seconds(), MPI_Wtime() - start});
  record["solver_iterations"] = to_record(last.iterations());
  directory.write("summary.json", to_text(record, 2) + "\n");
  print(last.process().description());
  print_numbers(setup, simulation);
  print("results in " + directory.path());
  const std::string& failure = simulation.shape().failure;
  if (!failure.empty()) throw NumericalError(failure);
}

FABSEQ_INSTANTIATE_FUNCTION(run_simulate);

}  // namespace fabseq
