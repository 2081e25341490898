// SPDX-License-Identifier: MIT
#include "process/last_solutions.h"

#include <algorithm>

namespace fabseq {

void LastSolutions::recall(const Place& place, std::span<const int> nodes, LaneVector& solution) {
  resize(some_, static_cast<int>(nodes.size()), solution.components, solution.lanes);
  const auto found = solutions_.find(key(place));
  if (found != solutions_.end() && found->second.size() == some_.values.size())
    std::ranges::copy(found->second, some_.values.begin());
  else
    std::ranges::fill(some_.values, 0.0);
  spread(some_, nodes, solution.nodes, solution);
}

void LastSolutions::keep(const Place& place, std::span<const int> nodes, const LaneVector& solution) {
  pick(solution, nodes, some_);
  solutions_[key(place)].assign(some_.values.begin(), some_.values.end());
}

}  // namespace fabseq
