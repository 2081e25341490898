// SPDX-License-Identifier: MIT
/// \file
/// One iteration as a line of history.jsonl (its keys: docs/reference.md, Output).
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/optimize/design_update.h"
#include "fabseq/optimize/iterate.h"
#include "fabseq/optimize/pipeline.h"
#include "fabseq/run/run_clock.h"

#include <array>
#include <cstdint>
#include <optional>

namespace fabseq {

/// Refers to what the iteration found out.
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
};

Json to_record(const HistoryLine& line);
/// Iterations of each solve, by kind of system.
Json to_record(const SolverIterations& iterations);

}  // namespace fabseq
