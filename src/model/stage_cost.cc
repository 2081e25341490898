// SPDX-License-Identifier: MIT
#include "fabseq/model/stage_cost.h"

#include <algorithm>

namespace fabseq {

namespace {

std::vector<NamedStageCost>& registered_costs() {
  static std::vector<NamedStageCost> costs;
  return costs;
}

}  // namespace

const std::vector<NamedStageCost>& stage_costs() { return registered_costs(); }

void register_stage_cost(const std::string& stage, CostOfStage cost) {
  std::vector<NamedStageCost>& costs = registered_costs();
  const auto place = std::ranges::upper_bound(costs, stage, {}, &NamedStageCost::stage);
  costs.insert(place, {stage, cost});
}

}  // namespace fabseq
