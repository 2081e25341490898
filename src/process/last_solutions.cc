// SPDX-License-Identifier: MIT
#include "process/last_solutions.h"

#include <algorithm>

namespace fabseq {

void LastSolutions::recall(const Place& place, std::span<const int> nodes, LaneVector& solution) const {
  LaneVector some(static_cast<int>(nodes.size()), solution.components, solution.lanes);
  const auto found = solutions_.find(key(place));
  if (found != solutions_.end() && found->second.size() == some.values.size())
    std::ranges::copy(found->second, some.values.begin());
  spread(some, nodes, solution.nodes, solution);
}

void LastSolutions::keep(const Place& place, std::span<const int> nodes, const LaneVector& solution) {
  LaneVector some;
  pick(solution, nodes, some);
  solutions_[key(place)].assign(some.values.begin(), some.values.end());
}

}  // namespace fabseq
