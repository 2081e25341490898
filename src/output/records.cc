// SPDX-License-Identifier: MIT
#include "fabseq/output/records.h"

#include "output/verdict_records.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fabseq {

namespace {

Json response_table(const std::vector<NamedValue>& responses) {
  Json table = Json::array();
  for (const auto& [name, type, value] : responses)
    table.push_back(Json::object({{"name", name}, {"type", type}, {"value", value}}));
  return table;
}

Json layer_table(const std::vector<LayerNumbers>& layers) {
  Json table = Json::array();
  for (const LayerNumbers& layer : layers) {
    Json entry =
        Json::object({{"volume", layer.volume}, {"thickness", layer.thickness}, {"cv", layer.variation}});
    if (layer.sub_part > 0) {
      entry["subpart"] = layer.sub_part;
      entry["slab"] = layer.slab;
    }
    if (layer.interpass) entry["interpass_temperature"] = *layer.interpass;
    table.push_back(entry);
  }
  return table;
}

/// Figures of all findings, the places where checks fail, and the sentences of each finding that has any.
void add_findings(Json& record, const Found& found, const ModelSettings& settings) {
  Json words = Json::object();
  for (const auto& [finding, numbers] : found.entries()) {
    numbers->add_record(record);
    if (std::vector<std::string> sentences = numbers->words(); !sentences.empty())
      words[finding] = std::move(sentences);
  }
  if (found.places) {
    record["places"] = to_record(*found.places, settings);
    record["places_in_all"] = found.places->in_all;
  }
  if (!found.entries().empty()) record["words"] = words;
}

Json sizes_record(const DisplacementSizes& sizes) {
  return Json::object(
      {{"displacement", to_record(sizes.part)}, {"nodes", sizes.nodes ? to_record(*sizes.nodes) : Json()}});
}

Json deposition_record(const DepositionNumbers& numbers) {
  Json terms = Json::array();
  for (const auto& [name, type, value] : numbers.distortions)
    terms.push_back(Json::object({{"name", name}, {"value", value}, {"length", std::sqrt(value)}}));
  Json record = sizes_record(numbers);
  record["distortion"] = terms;
  return record;
}

Json to_record(const Deviation& deviation) {
  Json record = sizes_record(deviation);
  record["stock"] = Json::object({{"outward", deviation.outward}, {"inward", deviation.inward}});
  record["skin"] = to_record(deviation.skin);
  record["scaled_drawing"] =
      Json::object({{"factor", deviation.scaled.factor}, {"rms", deviation.scaled.rms}});
  return record;
}

Json finished_record(const FinishedShape& shape) {
  Json record = Json::object({{"as_built", to_record(shape.as_built)},
                              {"released", shape.released ? to_record(*shape.released) : Json()}});
  if (!shape.failure.empty()) record["failure"] = shape.failure;
  return record;
}

Json scenario_table(const std::vector<ScenarioNumbers>& scenarios) {
  Json table = Json::array();
  for (const auto& [name, values, mean, spread, worst] : scenarios)
    table.push_back(Json::object(
        {{"name", name}, {"values", values}, {"mean", mean}, {"spread", spread}, {"worst", worst}}));
  return table;
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

Json binary_record(const JudgedValues& values) {
  Json record = Json::object({{"objective", first_components(values.objective)},
                              {"constraints", values.constraints},
                              {"worst_constraint", values.worst_constraint}});
  if (const auto& beyond = values.beyond_limits) {
    record["beyond_limits"] = beyond->share;
    record["places"] = beyond->places;
  }
  return record;
}

}  // namespace

Json to_record(const DisplacementSize& size) {
  return Json::object({{"max", size.largest}, {"rms", size.rms}});
}

void add_members(Json& record, const SequenceNumbers& numbers, const ModelSettings& settings) {
  record["responses"] = response_table(numbers.responses);
  record["layers"] = layer_table(numbers.layers);
  const auto& [own, other, own_model] = numbers.depositions;
  const bool is_nominal = own_model == DepositionModel::nominal;
  record["displacement"] = to_record(own.part);
  const Json of_own = deposition_record(own), of_other = other ? deposition_record(*other) : Json();
  record["deposition"] =
      Json::object({{"follow", is_nominal ? of_other : of_own}, {"nominal", is_nominal ? of_own : of_other}});
  add_findings(record, numbers.found, settings);
  if (numbers.verdict) record["verdict"] = to_record(*numbers.verdict);
  if (numbers.real_layers) record["real_layers"] = to_record(*numbers.real_layers, settings.unit);
  if (numbers.finished) record["finished"] = finished_record(*numbers.finished);
  if (!numbers.scenarios.empty()) record["scenarios"] = scenario_table(numbers.scenarios);
}

Json to_record(const SequenceNumbers& numbers, const ModelSettings& settings) {
  Json record = Json::object();
  add_members(record, numbers, settings);
  return record;
}

Json to_record(const SolverIterations& iterations) {
  Json record = Json::object(
      {{"primal", iterations.primal}, {"adjoint", iterations.adjoint}, {"heat", iterations.heat}});
  if (!iterations.temperature.empty()) record["temperature"] = iterations.temperature;
  return record;
}

Json to_record(const HistoryLine& line) {
  const ProblemValues& values = line.iterate.values;
  Json record = Json::object({{"iteration", line.iterate.iteration},
                              {"objective", first_components(values.objective)},
                              {"objective_scaled", values.scaled},
                              {"constraints", values.constraints},
                              {"worst_constraint", values.worst_constraint},
                              {"beta", line.iterate.beta},
                              {"change", line.step.change},
                              {"merit", values.merit},
                              {"interior_minima", line.interior_minima},
                              {"tolerance", line.tolerance},
                              {"optimizer", optimizer_record(line.step.mma)},
                              {"solver_iterations", to_record(line.solver_iterations)},
                              {"seconds", seconds_record(line.seconds)},
                              {"peak_memory_bytes", line.peak_memory_bytes}});
  if (line.temperature_range) record["temperature_range"] = *line.temperature_range;
  set_layer_variables(record, line.layer_variables, line.design);
  if (!values.limit_factors.empty()) record["limit_factors"] = values.limit_factors;
  if (has_functionals(values)) record["functionals"] = values.functionals;
  if (line.iterate.binary) record["binary"] = binary_record(*line.iterate.binary);
  return record;
}

Json to_record(const Summary& summary) {
  Json record = Json::object({{"name", summary.name},
                              {"status", summary.end.status},
                              {"reason", summary.end.reason},
                              {"iterations", summary.end.iterations},
                              {"ranks", summary.ranks},
                              {"layer_groups", summary.layer_groups},
                              {"part_elements", summary.part_elements},
                              {"seconds", seconds_record(summary.seconds)},
                              {"peak_memory_bytes", summary.peak_memory_bytes}});
  if (summary.coarse_iterations > 0) record["coarse_iterations"] = summary.coarse_iterations;
  if (!summary.starts.is_null()) record["starts"] = summary.starts;
  if (const auto& finish = summary.finish) {
    record["best_iteration"] = finish->best.iteration();
    record["feasible"] = finish->best.feasible();
    record["beta"] = finish->best.beta();
    record["worst_constraint"] = finish->best.worst_constraint();
    record["merit"] = finish->best.merit();
    record["optimized"] = to_record(finish->reports.optimized, summary.settings);
    record["binary"] = to_record(finish->reports.binary, summary.settings);
    if (const auto& start = finish->reports.start) record["start"] = to_record(*start, summary.settings);
  }
  if (summary.baseline != nullptr) record["baseline"] = to_record(*summary.baseline, summary.settings);
  if (const auto& finish = summary.finish) {
    for (const Baseline& baseline : finish->reports.baselines) {
      record[baseline.block] = to_record(baseline.numbers, summary.settings);
      add_directions(record[baseline.block], baseline);
    }
    Json limits = Json::array();
    for (const ConstraintLimit& limit : finish->reports.limits) limits.push_back(to_record(limit));
    record["constraints"] = limits;
    if (const auto& miss = finish->reports.miss) record["violated"] = to_record(*miss);
    record["headline"] = to_record(finish->headline);
    record["answer"] = answer_record(finish->headline, finish->reports, summary.settings);
    if (const auto& repair = finish->reports.repair) record["repair"] = to_record(*repair);
    record["interior_minima"] = finish->reports.interior_minima;
    set_layer_variables(record, finish->layer_variables, finish->best.design());
  }
  return record;
}

}  // namespace fabseq
