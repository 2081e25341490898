// SPDX-License-Identifier: MIT
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/output/records.h"
#include "fabseq/output/task_directory.h"
#include "fabseq/output/terminal.h"
#include "fabseq/tasks/starting_design.h"
#include "fabseq/tasks/tasks.h"

#include <algorithm>
#include <string>

namespace fabseq {

namespace {

/// NAME/design, and NAME/time_points or NAME/angles, where they are variables.
template <int Dim>
void write_gradient(Hdf5Writer& file, const Setup<Dim>& setup, const std::string& name,
                    const Design& gradient, bool has_field) {
  if (has_field) {
    const std::vector<double> field = setup.design_field(gradient.field);
    file.template write_field<Dim>(setup.grid, {name + "/design", setup.design_support.on_nodes(),
                                                setup.design_support.components(), field});
  }
  write_layer_variables(file, setup.layers->variables(), name + "/", gradient);
}

}  // namespace

template <int Dim>
void run_evaluate(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer) {
  const double tolerance = std::min(setup.config.solver.finest_tolerance(), 1e-9);
  Pipeline<Dim> pipeline(setup, tolerance, timer);
  pipeline.set_region(setup.config.solver.region_of_evaluations());
  Problem<Dim> problem(setup, setup.config.optimizer.constraint_margin);
  const Design design = starting_design(setup, pipeline.sequence(), command_line);
  const OutputDirectory directory = make_output_directory(setup, command_line);
  const StopFile stop_file(setup.groups.domain(), directory.file("stop"));

  const auto state = pipeline.run(design, setup.layers->traits().first_beta, setup.binary());
  const SequenceReport report = report_sequence(setup, problem, pipeline, state, /*with_shape=*/false);
  const std::vector<GradientRow> rows = all_components(report.values);
  const auto gradients = pipeline.gradients(problem.responses(), state, rows);

  Hdf5Writer file(setup.world(), directory.file("gradients.h5"));
  for (std::size_t row = 0; row < rows.size(); ++row)
    write_gradient(file, setup, problem.component_name(rows[row][0].response, rows[row][0].component),
                   gradients[row], pipeline.sequence().has_design());
  file.close();
  Json record = Json::object({{"beta", setup.layers->traits().first_beta}, {"binary", setup.binary()}});
  add_members(record, report, setup.settings);
  set_layer_variables(record, setup.layers->variables(), design);
  record["solver_iterations"] = to_record(pipeline.iterations());
  directory.write("evaluation.json", to_text(record, 2) + "\n");
  print_responses(report);
  print("values and gradients in " + directory.path());
}

FABSEQ_INSTANTIATE_FUNCTION(run_evaluate);

}  // namespace fabseq
