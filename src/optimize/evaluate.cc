#include "fabseq/base/error.h"
#include "fabseq/base/hdf5.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/io/hdf5_writer.h"
#include "fabseq/optimize/run_output.h"
#include "fabseq/optimize/tasks.h"

#include <algorithm>

namespace fabseq {

double evaluation_tolerance(const Config& config) { return std::min(config.solver.tolerance, 1e-9); }

template <int Dim>
std::vector<double> starting_design(const Setup<Dim>& setup, const Sequence<Dim>& sequence,
                                    const CommandLine& command_line) {
  if (!command_line.design_file || !sequence.has_design())
    return setup.groups.share(sequence.initial_design());
  const std::string& file = *command_line.design_file;
  if (!hdf5_file_has(setup.world(), file, "design", "-design")) {
    warn("-design: '" + file + "' has no dataset 'design': the initial values are taken");
    return setup.groups.share(sequence.initial_design());
  }
  std::vector<double> design =
      setup.part.restrict_to_part(read_element_field(setup.grid, file, "design", "-design", "-design"));
  const DesignSpace space = sequence.space();
  constexpr double rounding = 1e-9;
  bool outside = false;
  for (const double value : design)
    outside =
        outside || !(value >= space.lower * (1.0 - rounding) && value <= space.upper * (1.0 + rounding));
  if (any(setup.world(), outside))
    throw InputError("-design: " + file + " has values outside the bounds " + Json(space.lower).dump() +
                     " to " + Json(space.upper).dump() + " of /sequence/bounds on the part's elements");
  return setup.groups.share(design);
}

namespace {

/// A gradient row for every component of every response.
template <int Dim>
std::vector<GradientRow> all_components(const std::vector<std::vector<double>>& values) {
  std::vector<GradientRow> rows;
  for (std::size_t r = 0; r < values.size(); ++r)
    for (std::size_t c = 0; c < values[r].size(); ++c)
      rows.push_back({{static_cast<int>(r), static_cast<int>(c), 1.0}});
  return rows;
}

}  // namespace

template <int Dim>
void run_evaluate(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer) {
  const double tolerance = evaluation_tolerance(setup.config);
  Pipeline<Dim> pipeline(setup, make_sequence(setup, tolerance), tolerance, timer);
  Problem<Dim> problem(setup);
  const std::vector<double> design = starting_design(setup, pipeline.sequence(), command_line);
  const OutputDirectory directory = make_output_directory(setup, command_line);

  const auto state = pipeline.run(design, setup.layer_count, setup.first_beta(), setup.binary());
  const SequenceReport<Dim> report = report_sequence(setup, problem, pipeline, state);
  const std::vector<GradientRow> rows = all_components<Dim>(report.values);
  const auto gradients = pipeline.gradients(problem.responses(), state, rows);

  Hdf5Writer file(setup.world(), directory.file("gradients.h5"));
  for (std::size_t row = 0; pipeline.sequence().has_design() && row < rows.size(); ++row) {
    const std::vector<double> gradient = setup.design_field(gradients[row]);
    FieldSet<Dim> fields;
    fields.grid = &setup.grid;
    fields.add_elements(problem.component_name(rows[row][0].response, rows[row][0].component) + "/design",
                        gradient);
    file.template write_fields<Dim>(fields);
  }
  file.close();
  Json record = Json::object({{"beta", setup.first_beta()}, {"binary", setup.binary()}});
  for (const auto& [key, value] : report.block.members()) record.set(key, value);
  const SolverIterations& solves = pipeline.iterations();
  record.set("solver_iterations",
             Json::object({{"primal", solves.primal}, {"adjoint", solves.adjoint}, {"heat", solves.heat}}));
  directory.write("evaluation.json", record.dump(2) + "\n");
  for (const Json& response : report.block.at("responses").items())
    print(response.at("name").string() + " (" + response.at("type").string() +
          "): " + response.at("value").dump());
  print("values and gradients in " + directory.path());
}

#define FABSEQ_INSTANTIATE(Dim)                                                              \
  template std::vector<double> starting_design<Dim>(const Setup<Dim>&, const Sequence<Dim>&, \
                                                    const CommandLine&);                     \
  template void run_evaluate<Dim>(const CommandLine&, const Setup<Dim>&, PhaseTimer&);
FABSEQ_INSTANTIATE(2)
FABSEQ_INSTANTIATE(3)
#undef FABSEQ_INSTANTIATE

}  // namespace fabseq
