// SPDX-License-Identifier: MIT
#include "ranks/level_shares.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

template <int Dim>
LevelShares<Dim> LevelShares<Dim>::finest(const Decomposition<Dim>& ranges) {
  LevelShares result{ranges, {}};
  result.ranks.resize(static_cast<std::size_t>(IndexBox<Dim>{Index<Dim>{}, ranges.processes}.count()));
  std::iota(result.ranks.begin(), result.ranks.end(), 0);
  return result;
}

template <int Dim>
int LevelShares<Dim>::process_of(int rank) const {
  const auto found = std::find(ranks.begin(), ranks.end(), rank);
  return found == ranks.end() ? -1 : static_cast<int>(found - ranks.begin());
}

template <int Dim>
void LevelShares<Dim>::halve(int axis) {
  const LevelShares old = *this;
  const int processes = (old.ranges.processes[axis] + 1) / 2;
  ranges.processes[axis] = processes;
  std::vector<int>& starts = ranges.range_starts[axis];
  for (int process = 0; process < processes; ++process)
    starts[process] = old.ranges.range_starts[axis][2 * process];
  starts[processes] = old.ranges.range_starts[axis].back();
  starts.resize(static_cast<std::size_t>(processes) + 1);
  const IndexBox<Dim> positions{Index<Dim>{}, ranges.processes};
  ranks.resize(static_cast<std::size_t>(positions.count()));
  positions.for_each([&](Index<Dim> position, std::int64_t process) {
    position[axis] *= 2;
    ranks[process] = old.ranks[old.ranges.rank_at(position)];
  });
}

template <int Dim>
LevelShares<Dim> LevelShares<Dim>::coarsened(const Index<Dim>& factors, std::int64_t active) const {
  LevelShares coarse = *this;
  for (const int factor : factors) active /= factor;
  for (int axis = 0; axis < Dim; ++axis) {
    std::vector<int>& starts = coarse.ranges.range_starts[axis];
    for (int& start : starts) start = (start + factors[axis] - 1) / factors[axis];
    while (std::adjacent_find(starts.begin(), starts.end()) != starts.end()) coarse.halve(axis);
  }
  while (coarse.count() > 1 && active < least_blocks * coarse.count()) {
    const auto length = [&](int axis) {
      const int processes = coarse.ranges.processes[axis];
      return static_cast<double>(coarse.ranges.range_starts[axis].back()) / processes;
    };
    int shortest = -1;
    for (int axis = 0; axis < Dim; ++axis)
      if (coarse.ranges.processes[axis] > 1 && (shortest < 0 || length(axis) < length(shortest)))
        shortest = axis;
    coarse.halve(shortest);
  }
  return coarse;
}

template <int Dim>
bool LevelShares<Dim>::stay_in_place(const LevelShares& next, const Index<Dim>& factors) const {
  if (ranks != next.ranks) return false;
  for (int axis = 0; axis < Dim; ++axis) {
    const std::vector<int>& starts = ranges.range_starts[axis];
    if (std::any_of(starts.begin(), starts.end() - 1, [&](int start) { return start % factors[axis] != 0; }))
      return false;
  }
  return true;
}

FABSEQ_INSTANTIATE_STRUCT(LevelShares);

}  // namespace fabseq
