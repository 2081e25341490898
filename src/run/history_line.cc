// SPDX-License-Identifier: MIT
#include "fabseq/run/history_line.h"

#include "fabseq/run/layer_variable_output.h"

#include <algorithm>
#include <vector>

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

Json optimizer_record(const MmaReport& mma) {
  return Json::object({{"newton_steps", mma.newton_steps},
                       {"residual", mma.kkt_residual},
                       {"relaxation", mma.largest_violation}});
}

Json binary_record(const ProblemValues& values) {
  return Json::object({{"objective", first_components(values.objective)},
                       {"constraints", lists(values.constraints)},
                       {"worst_constraint", values.worst_constraint}});
}

}  // namespace

Json to_record(const SolverIterations& iterations) {
  return Json::object(
      {{"primal", iterations.primal}, {"adjoint", iterations.adjoint}, {"heat", iterations.heat}});
}

Json to_record(const HistoryLine& line) {
  const ProblemValues& values = line.iterate.values;
  Json record = Json::object({{"iteration", line.iterate.iteration},
                              {"objective", first_components(values.objective)},
                              {"objective_scaled", values.scaled},
                              {"constraints", lists(values.constraints)},
                              {"worst_constraint", values.worst_constraint},
                              {"beta", line.iterate.beta},
                              {"change", line.step.change},
                              {"merit", values.merit},
                              {"interior_minima", line.interior_minima},
                              {"optimizer", optimizer_record(line.step.mma)},
                              {"solver_iterations", to_record(line.solver_iterations)},
                              {"seconds", seconds_record(line.seconds)},
                              {"peak_memory_bytes", line.peak_memory_bytes}});
  if (line.temperature_range)
    record["temperature_range"] =
        std::vector<double>{(*line.temperature_range)[0], (*line.temperature_range)[1]};
  set_layer_variables(record, line.layer_variables, line.design);
  if (has_functionals(values)) record["functionals"] = lists(values.functionals);
  if (line.iterate.binary) record["binary"] = binary_record(*line.iterate.binary);
  return record;
}

}  // namespace fabseq
