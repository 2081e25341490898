// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/process/residual_stress.h"
#include "fabseq/run/layer_variable_output.h"
#include "fabseq/run/run_output.h"
#include "fabseq/run/tasks.h"

#include <cmath>
#include <optional>
#include <span>

namespace fabseq {

namespace {

/// sqrt of the sum over all nodes of |increment|^2, a layer each.
template <int Dim>
std::vector<double> increment_norms(const ProcessSimulation<Dim>& process, int layers, MPI_Comm comm) {
  std::vector<double> norms(layers, 0.0);
  for (int j = 0; j < layers; ++j)
    for (const double u : process.increment(j)) norms[j] += u * u;
  sum_in_place(comm, norms);
  for (double& norm : norms) norm = std::sqrt(norm);
  return norms;
}

/// Displacement after every layer, as stages/displacement.
template <int Dim>
void write_stages(Hdf5Writer& file, const Setup<Dim>& setup, const ProcessSimulation<Dim>& process,
                  int layers) {
  std::vector<double> displacement(static_cast<std::size_t>(setup.grid.owned_nodes().count()) * Dim, 0.0);
  for (int j = 0; j < layers; ++j) {
    const std::vector<double> increment = process.increment(j);
    for (std::size_t i = 0; i < displacement.size(); ++i) displacement[i] += increment[i];
    file.template write_stage<Dim>(setup.grid, {"stages/displacement", true, Dim, displacement, true}, j,
                                   layers);
  }
}

/// Release from plate or clamps. Empty if the part falls apart then, which is warned about, or, with
/// `failure` the reason, if the solve fails: the simulation is done by then and shall not be lost.
template <int Dim>
std::vector<double> try_release(const Setup<Dim>& setup, const ProcessSimulation<Dim>& process,
                                const PipelineState<Dim>& state, std::string& failure) {
  if (!state.process.release.empty()) return state.process.release;  // a term asked for it
  const std::string obstacle = release_obstacle(setup.grid, setup.supports, setup.config.process.void_model);
  if (!obstacle.empty()) {
    warn("no release_displacement: " + obstacle);
    return {};
  }
  const std::vector<double> reactions = process.reactions(state.layers);
  std::vector<double> release;
  try {
    process.groups().run([&] {
      Release<Dim> solver(process.model(), release_solver(setup.config, setup.config.solver.tolerance));
      release = solver.displacement(reactions);
    });
  } catch (const NumericalError& error) {
    failure = error.what();
    return {};
  }
  return release;
}

template <int Dim>
Json stress_record(const Part<Dim>& part, std::span<const double> stress) {
  const StressExtremes<Dim> extremes = stress_extremes(part, stress);
  return Json::object({{"von_mises", extremes.von_mises},
                       {"lowest", std::vector<double>(extremes.lowest.begin(), extremes.lowest.end())},
                       {"highest", std::vector<double>(extremes.highest.begin(), extremes.highest.end())}});
}

/// Displacement and stress once the part is released.
template <int Dim>
struct Released {
  std::vector<double> displacement, stress;

  Released(const ElasticModel<Dim>& model, std::span<const double> before,
           std::span<const double> stress_before, std::span<const double> release)
      : displacement(before.begin(), before.end()), stress(finished_stress(model, release)) {
    for (std::size_t i = 0; i < displacement.size(); ++i) displacement[i] += release[i];
    for (std::size_t i = 0; i < stress.size(); ++i) stress[i] += stress_before[i];
  }
};

}  // namespace

template <int Dim>
void run_simulate(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer) {
  const double start = MPI_Wtime();
  const double tolerance = setup.config.solver.tolerance;
  Pipeline<Dim> pipeline(setup, make_sequence(setup, tolerance), make_layers(setup, tolerance), tolerance,
                         timer);
  const Problem<Dim> problem(setup);
  const Design design = starting_design(setup, pipeline.sequence(), command_line);
  const OutputDirectory directory = make_output_directory(setup, command_line);
  const StopFile stop_file(setup.groups.domain(), directory.file("stop"));

  const auto state = pipeline.run(design, setup.layer_count, setup.first_beta(), setup.binary());
  const SequenceReport<Dim> report = report_sequence(setup, problem, pipeline, state);
  const std::vector<double> stress = residual_stress(pipeline.process(), state.layers);
  std::string failure;
  const std::vector<double> release = try_release(setup, pipeline.process(), state, failure);
  std::optional<Released<Dim>> released;
  if (!release.empty())
    released.emplace(pipeline.process().model(), state.process.displacement, stress, release);
  const std::vector<double> norms =
      increment_norms(pipeline.process(), state.layers.count(), setup.grid.comm());

  const bool has_design = pipeline.sequence().has_design();
  const std::vector<double> design_field =
      has_design ? setup.design_field(design.field) : std::vector<double>();
  const std::vector<double> substrate = setup.substrate_field();
  FieldSet<Dim> fields;
  fields.grid = &setup.grid;
  fields.add_elements("density", setup.part.density());
  if (setup.part.substrate().count() > 0) fields.add_elements("substrate", substrate);
  if (has_design) fields.add(setup.design_support.on_nodes(), "design", design_field);
  report.add_fields(fields, "");
  if (released) fields.add_nodes("release_displacement", release, Dim);
  fields.add_elements("residual_stress", stress, voigt_size<Dim>);
  if (released) fields.add_elements("released_stress", released->stress, voigt_size<Dim>);
  Hdf5Writer file(setup.world(), directory.file("result.h5"));
  file.template write_fields<Dim>(fields);
  write_layer_variables(file, setup.layer_variables, "", design);
  file.write_array("layer_displacement_norms", norms);
  if (setup.config.output.stages) write_stages(file, setup, pipeline.process(), state.layers.count());
  file.write_attribute("name", setup.config.name);
  for (const Json& response : report.block.at("responses"))
    file.write_attribute(response.at("name").get<std::string>(), response.at("value"));
  file.close();
  directory.write("result.xdmf", hdf5_xdmf<Dim>(fields, "result.h5"));

  Json record = Json::object({{"name", setup.config.name},
                              {"status", failure.empty() ? "converged" : "failed"},
                              {"reason", failure.empty() ? "simulated" : failure}});
  for (const auto& [key, value] : report.block) record[key] = value;
  set_layer_variables(record, setup.layer_variables, design);
  record["layer_displacement_norms"] = norms;
  record["residual_stress"] = stress_record(setup.part, stress);
  if (released)
    record["released"] =
        Json::object({{"displacement", displacement_size(setup.part, released->displacement)},
                      {"residual_stress", stress_record(setup.part, released->stress)}});
  record["seconds"] = seconds_record(timer.seconds(), MPI_Wtime() - start);
  record["peak_memory_bytes"] = peak_memory_bytes(setup.world());
  directory.write("summary.json", to_text(record, 2) + "\n");
  print(pipeline.process().solver_description());
  print("largest displacement " + report.block.at("displacement").at("max").dump() + ", rms " +
        report.block.at("displacement").at("rms").dump());
  if (released)
    print("after the release: largest displacement " +
          record.at("released").at("displacement").at("max").dump() + ", largest equivalent stress " +
          record.at("released").at("residual_stress").at("von_mises").dump() +
          " (before: " + record.at("residual_stress").at("von_mises").dump() + ")");
  for (const Json& response : report.block.at("responses"))
    print(response.at("name").get<std::string>() + " (" + response.at("type").get<std::string>() +
          "): " + response.at("value").dump());
  print("results in " + directory.path());
  if (!failure.empty()) throw NumericalError(failure);
}

template void run_simulate<2>(const CommandLine&, const Setup<2>&, PhaseTimer&);
template void run_simulate<3>(const CommandLine&, const Setup<3>&, PhaseTimer&);

}  // namespace fabseq
