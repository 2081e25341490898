// SPDX-License-Identifier: MIT
/// \file
/// How an optimization ended: summary.json (its keys: docs/reference.md, Output).
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/optimize/run_state.h"
#include "fabseq/run/run_clock.h"
#include "fabseq/run/sequence_report.h"

#include <cstdint>
#include <optional>
#include <string>

namespace fabseq {

/// What only a run has that was not interrupted.
struct Finish {
  const BestIterate& best;
  const SequenceNumbers& optimized;
  const SequenceNumbers& binary;
  std::int64_t interior_minima;
  const LayerVariables& layer_variables;
};

struct Summary {
  std::string name;
  RunEnd end;
  int ranks = 1, layer_groups = 1;
  std::int64_t part_elements = 0;
  Seconds seconds;
  std::int64_t peak_memory_bytes = 0;
  int coarse_iterations = 0;
  const SequenceNumbers* baseline = nullptr;  ///< nullptr: the run did not get there
  std::optional<Finish> finish;
};

Json to_record(const Summary& summary);

}  // namespace fabseq
