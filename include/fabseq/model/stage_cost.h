// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/model/run_size.h"

#include <string>
#include <vector>

namespace fabseq {

/// What a stage costs in a run.
struct StageCost {
  double held = 0.0;  ///< memory throughout, all ranks, bytes
  double solving =
      0.0;            ///< memory while it solves, all ranks, bytes; with few lanes one stage at a time has it
  double work = 0.0;  ///< time of the slowest group, in units of a full block of layers on one rank
  double work_of_other_groups =
      0.0;               ///< what the other groups do meanwhile, the sum of their times, in these units
  double seconds = 0.0;  ///< per design iteration, all ranks busy
};

/// The cost for a run of this size.
using CostOfStage = StageCost (*)(const RunSize& size, SolverPath path, int groups, int lanes);

/// A stage's name and what it costs.
struct NamedStageCost {
  std::string stage;
  CostOfStage of;
};

/// Returns the costs of all types of stages, by name.
const std::vector<NamedStageCost>& stage_costs();
/// Adds one. RegisteredStage calls it.
void register_stage_cost(const std::string& stage, CostOfStage cost);

}  // namespace fabseq
