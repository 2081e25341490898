// SPDX-License-Identifier: MIT
#include "tasks/sensitivity.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/base/stop.h"
#include "fabseq/chain/stages.h"
#include "fabseq/config/reslicing.h"
#include "fabseq/output/task_directory.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/tasks/starting_design.h"
#include "fabseq/tasks/tasks.h"

#include <cmath>
#include <utility>

namespace fabseq {

namespace {

/// Names of the objective's distortion terms.
std::vector<std::string> distortion_names(const std::vector<Term>& objective) {
  std::vector<std::string> result;
  for (std::size_t k = 0; k < objective.size(); ++k)
    if (objective[k].type->name == "distortion") result.push_back("objective_" + std::to_string(k));
  return result;
}

SensitivityRow skipped_row(const std::string& change, const std::string& reason) {
  warn("sensitivity, " + change + ": " + reason);
  return {change, reason, {}, {}};
}

template <int Dim>
SensitivityRow row_of(const Setup<Dim>& setup, const GivenDesign<Dim>& given, const Variation& variation,
                      PhaseTimer& timer) {
  if (const std::string obstacle = variation.finer ? obstacle_of_finer_grid(setup) : ""; !obstacle.empty())
    return skipped_row(variation.name, obstacle);
  try {
    const VariedPair pair = simulate_varied(setup, given, variation, false, timer);
    return {variation.name, "", pair.sequence.own, pair.planar.own, variation.layers_times};
  } catch (const InputError& error) {
    return skipped_row(variation.name, error.what());
  } catch (const NumericalError& error) {
    return skipped_row(variation.name, error.what());
  }
}

template <int Dim>
SensitivityTable sensitivity_table(const Setup<Dim>& setup, const GivenDesign<Dim>& given,
                                   PhaseTimer& timer) {
  const std::vector<Variation> variations = all_variations(setup);
  const auto [sequence, planar] = simulate_varied(setup, given, variations.front(), true, timer);
  std::vector<SensitivityRow> rows = {
      {variations.front().name, "", sequence.own, planar.own},
      {"noise of each layer's strain, 10 %", "", *sequence.noise, *planar.noise}};
  for (std::size_t i = 1; i < variations.size(); ++i) {
    stop_if_requested(setup.world());
    rows.push_back(row_of(setup, given, variations[i], timer));
  }
  const bool is_nominal = setup.config.process.deposition == DepositionModel::nominal;
  rows.push_back({std::string("deposition ") + (is_nominal ? "follow" : "nominal"), "",
                  *sequence.other_deposition, *planar.other_deposition});
  return {setup.config.name, distortion_names(setup.config.objective), std::move(rows)};
}

}  // namespace

template <int Dim>
void write_sensitivity(const Setup<Dim>& setup, Sequence<Dim>& sequence, const Design& design, double beta,
                       const OutputDirectory& directory, PhaseTimer& timer) {
  const PseudoTime<Dim>& time = sequence.update(setup.groups.gather(design.field));
  GivenDesign<Dim> given;
  given.layer_variables = design.layer_variables;
  given.beta = beta;
  given.time.time = time.time;
  given.time.gradient = time.gradient;
  const SensitivityTable table = sensitivity_table(setup, given, timer);
  directory.write("sensitivity.json", to_text(table.json(), 2) + "\n");
  directory.write("sensitivity.csv", table.csv());
  for (const std::string& line : table.text()) print(line);
  print("picture: fabseq-tools plot-sensitivity " + directory.path());
}

template <int Dim>
void run_sensitivity(const CommandLine& command_line, const Setup<Dim>& setup, PhaseTimer& timer) {
  const auto sequence = make_sequence(setup, setup.config.solver.finest_tolerance());
  const Design design = starting_design(setup, *sequence, command_line);
  double beta = setup.layers->traits().first_beta;
  if (command_line.design_file)
    if (const Slicing of_file = slicing_of(setup.world(), *command_line.design_file); of_file.beta > 0.0)
      beta = of_file.beta;
  const OutputDirectory directory = make_output_directory(setup, command_line);
  const StopFile stop_file(setup.groups.domain(), directory.file("stop"));
  write_sensitivity(setup, *sequence, design, beta, directory, timer);
  print("results in " + directory.path());
}

FABSEQ_INSTANTIATE_FUNCTION(write_sensitivity);
FABSEQ_INSTANTIATE_FUNCTION(run_sensitivity);

}  // namespace fabseq
