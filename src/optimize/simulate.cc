#include "fabseq/base/error.h"
#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/io/hdf5_writer.h"
#include "fabseq/optimize/run_output.h"
#include "fabseq/optimize/tasks.h"
#include "fabseq/process/residual_stress.h"

#include <cmath>

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

/// Release from the plate; empty, and `failure` the reason, where its solve fails: the simulation is done by
/// then and shall not be lost.
template <int Dim>
std::vector<double> try_release(const ProcessSimulation<Dim>& process, const LayerDensities& layers,
                                AssembledSolverSettings solver, std::string& failure) {
  solver.options_prefix = "release_";
  try {
    std::vector<double> release;
    process.groups().run([&] { release = release_displacement(process, layers, solver); });
    return release;
  } catch (const NumericalError& error) {
    failure = error.what();
    return {};
  }
}

}  // namespace

template <int Dim>
void run_simulate(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer) {
  const double start = MPI_Wtime();
  const double tolerance = setup.config.solver.tolerance;
  Pipeline<Dim> pipeline(setup, make_sequence(setup, tolerance), tolerance, timer);
  const Problem<Dim> problem(setup);
  const Design design = starting_design(setup, pipeline.sequence(), command_line);
  const OutputDirectory directory = make_output_directory(setup, command_line);

  const auto state = pipeline.run(design, setup.layer_count, setup.first_beta(), setup.binary());
  const SequenceReport<Dim> report = report_sequence(setup, problem, pipeline, state);
  const std::vector<double> stress = residual_stress(pipeline.process(), state.layers);
  std::string failure;
  const std::vector<double> release = try_release(
      pipeline.process(), state.layers, elasticity_solver_settings(setup.config, tolerance), failure);
  const std::vector<double> norms = increment_norms(pipeline.process(), setup.layer_count, setup.grid.comm());

  const bool has_design = pipeline.sequence().has_design();
  const std::vector<double> design_field =
      has_design ? setup.design_field(design.field) : std::vector<double>();
  FieldSet<Dim> fields;
  fields.grid = &setup.grid;
  fields.add_elements("density", setup.part.density());
  if (has_design) fields.add(setup.design_support.on_nodes(), "design", design_field);
  report.add_fields(fields, "");
  if (failure.empty()) fields.add_nodes("release_displacement", release, Dim);
  fields.add_elements("residual_stress", stress, voigt_size<Dim>);
  Hdf5Writer file(setup.world(), directory.file("result.h5"));
  file.template write_fields<Dim>(fields);
  if (!design.time_points.empty()) file.write_array("time_points", design.time_points);
  file.write_array("layer_displacement_norms", norms);
  if (setup.config.output.stages) write_stages(file, setup, pipeline.process(), setup.layer_count);
  file.write_attribute("name", setup.config.name);
  for (const Json& response : report.block.at("responses").items())
    file.write_attribute(response.at("name").string(), response.at("value"));
  file.close();
  directory.write("result.xdmf", hdf5_xdmf<Dim>(fields, "result.h5"));

  Json record = Json::object({{"name", setup.config.name},
                              {"status", failure.empty() ? "converged" : "failed"},
                              {"reason", failure.empty() ? "simulated" : failure}});
  for (const auto& [key, value] : report.block.members()) record.set(key, value);
  if (!design.time_points.empty()) record.set("time_points", design.time_points);
  record.set("layer_displacement_norms", norms);
  record.set("seconds", seconds_record(timer.seconds(), MPI_Wtime() - start));
  record.set("peak_memory_bytes", peak_memory_bytes(setup.world()));
  directory.write("summary.json", record.dump(2) + "\n");
  print(pipeline.process().solver_description());
  print("largest displacement " + report.block.at("displacement").at("max").dump() + ", rms " +
        report.block.at("displacement").at("rms").dump());
  for (const Json& response : report.block.at("responses").items())
    print(response.at("name").string() + " (" + response.at("type").string() +
          "): " + response.at("value").dump());
  print("results in " + directory.path());
  if (!failure.empty()) throw NumericalError(failure);
}

template void run_simulate<2>(const CommandLine&, const Setup<2>&, PhaseTimer&);
template void run_simulate<3>(const CommandLine&, const Setup<3>&, PhaseTimer&);

}  // namespace fabseq
