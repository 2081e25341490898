// SPDX-License-Identifier: MIT
/// \file
/// What is found out, as JSON: history.jsonl, summary.json, evaluation.json (their keys: docs/reference.md
/// and docs/developer/files.md).
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/chain/design.h"
#include "fabseq/chain/pipeline.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/layers/layer_model.h"
#include "fabseq/optimize/best_iterate.h"
#include "fabseq/optimize/design_update.h"
#include "fabseq/optimize/run_state.h"
#include "fabseq/output/run_clock.h"
#include "fabseq/report/headline.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace fabseq {

/// A line of history.jsonl; refers to what the iteration found out.
struct HistoryLine {
  const Iterate& iterate;
  const StepReport& step;
  const SolverIterations& solver_iterations;
  const LayerVariables& layer_variables;
  const Design& design;
  std::int64_t interior_minima = 0;
  std::optional<std::array<double, 2>> temperature_range = {};  ///< of sequences with a temperature
  Seconds seconds = {};
  std::int64_t peak_memory_bytes = 0;
  double tolerance = 0.0;  ///< of the elastic solves
};

Json to_record(const HistoryLine& line);
/// Iterations of each solve, by kind of system.
Json to_record(const SolverIterations& iterations);

/// What only a run has that was not interrupted.
struct Finish {
  const FinalReports& reports;
  const BestIterate& best;
  const LayerVariables& layer_variables;
  Headline headline;
};

/// summary.json: how an optimization ended.
struct Summary {
  std::string name;  ///< of the run
  const ModelSettings& settings;
  RunEnd end;
  int ranks = 1, layer_groups = 1;
  std::int64_t part_elements = 0;
  Seconds seconds;
  std::int64_t peak_memory_bytes = 0;
  int coarse_iterations = 0;
  Json starts = {};                           ///< null: the run began with a single design
  const SequenceNumbers* baseline = nullptr;  ///< nullptr: the run did not get there
  std::optional<Finish> finish;
};

Json to_record(const Summary& summary);

/// Numbers of a sequence; add_members() puts its members into another record.
Json to_record(const SequenceNumbers& numbers, const ModelSettings& settings);
void add_members(Json& record, const SequenceNumbers& numbers, const ModelSettings& settings);
Json to_record(const DisplacementSize& size);
/// The constraint that is missed by most.
Json to_record(const ConstraintMiss& miss);
/// The block "repair".
Json to_record(const RepairReport& repair);

/// Variables of the layers, where a design has them, as a dataset GROUP + their name; `group` ends in '/' or
/// is empty. Collective on the writer's communicator.
inline void write_layer_variables(Hdf5Writer& file, const LayerVariables& variables, const std::string& group,
                                  const Design& design) {
  if (!design.layer_variables.empty())
    file.write_array(group + variables.name, design.layer_variables, variables.columns);
}

/// The same as a member of a record.
inline void set_layer_variables(Json& record, const LayerVariables& variables, const Design& design) {
  if (!design.layer_variables.empty()) record[variables.name] = variables.record(design.layer_variables);
}

}  // namespace fabseq
