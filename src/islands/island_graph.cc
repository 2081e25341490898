// SPDX-License-Identifier: MIT
#include "islands/island_graph.h"

#include "islands/disjoint_sets.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>
#include <utility>

namespace fabseq {

std::int64_t RiseOrder::depth_of(double stiffness) {
  constexpr int shift = 50;
  return -static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(stiffness) >> shift);
}

void Basin::add(const RiseOrder& turn, bool is_supported) {
  ++size;
  if (is_supported) supported = std::min(supported, turn);
  if (!(turn < first.back())) return;
  first.back() = turn;
  for (int i = smallest - 1; i > 0 && first[i] < first[i - 1]; --i) std::swap(first[i], first[i - 1]);
}

void Basin::take_in(const Basin& other) {
  std::array<RiseOrder, 2 * smallest> both;
  std::merge(first.begin(), first.end(), other.first.begin(), other.first.end(), both.begin());
  std::copy_n(both.begin(), smallest, first.begin());
  size += other.size;
  peak = std::max(peak, other.peak);
  supported = std::min(supported, other.supported);
}

IslandLimits::IslandLimits(double least, double largest, double peak_over_saddle, int most_islands)
    : floor(3.0 * least),
      least_peak(peak_over_saddle * least),
      contrast(peak_over_saddle),
      // One step less than the depth of the softest possible saddle, so that rounding does not matter.
      core_depth(RiseOrder::depth_of(largest / peak_over_saddle) - 1),
      most(most_islands) {}

bool IslandLimits::precedes(const Basin& a, const Basin& b) {
  return std::tie(b.size, a.first[0]) < std::tie(a.size, b.first[0]);
}

namespace {

/// The basins of a field while they meet. Basins that have met are in a component, which its main basin
/// stands for; islands that have ended are in it, too.
class MeetingBasins {
 public:
  MeetingBasins(std::span<const Basin> basins, const IslandLimits& limits)
      : limits_(limits),
        properties_(basins.begin(), basins.end()),
        basins_(basins.size()),
        components_(basins.size()),
        main_basin_(basins.size()),
        is_island_(basins.size(), 0) {
    std::iota(main_basin_.begin(), main_basin_.end(), 0);
  }

  void meet(const Saddle& saddle, int basin, int neighbor) {
    const int first = components_.find(basin), second = components_.find(neighbor);
    if (first == second) return;
    int greater = basins_.find(main_basin_[first]), lesser = basins_.find(main_basin_[second]);
    if (saddle.kind == Saddle::core) {
      take_in(lesser, greater);
    } else if (saddle.kind == Saddle::link) {
      greater = lesser;
      take_in(basins_.find(basin), basins_.find(neighbor));
    } else {
      const auto is_supported = [&](int number) { return properties_[number].supported <= saddle.turn; };
      const bool swap = is_supported(greater) != is_supported(lesser)
                            ? is_supported(lesser)
                            : properties_[lesser].peak > properties_[greater].peak;
      if (swap) std::swap(greater, lesser);
      const Basin& ends = properties_[lesser];
      if (ends.may_end(saddle.turn) && ends.peak > limits_.contrast * saddle.stiffness)
        is_island_[lesser] = 1;
      else
        take_in(lesser, greater);
    }
    components_.join(second, first);
    main_basin_[first] = greater;
  }

  /// What no saddle has ended.
  void end_components() {
    for (int basin = 0; basin < components_.size(); ++basin) {
      const int main = basins_.find(main_basin_[components_.find(basin)]);
      if (limits_.is_island(properties_[main])) is_island_[main] = 1;
    }
  }

  BasinIslands islands() {
    std::vector<int> order;
    for (int basin = 0; basin < basins_.size(); ++basin)
      if (is_island_[basin] != 0) order.push_back(basin);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return IslandLimits::precedes(properties_[a], properties_[b]); });
    BasinIslands result;
    result.count = std::min(limits_.most, static_cast<int>(order.size()));
    std::vector<int> number(properties_.size(), -1);
    for (int i = 0; i < result.count; ++i) number[order[i]] = i;
    for (int basin = 0; basin < basins_.size(); ++basin)
      result.of_basin.push_back(number[basins_.find(basin)]);
    return result;
  }

 private:
  void take_in(int lesser, int greater) {
    properties_[greater].take_in(properties_[lesser]);
    basins_.join(lesser, greater);
  }

  IslandLimits limits_;
  std::vector<Basin> properties_;  ///< at the representatives of `basins_`
  DisjointSets basins_, components_;
  std::vector<int> main_basin_;  ///< of each component, at its representative
  std::vector<char> is_island_;
};

}  // namespace

BasinIslands find_islands(std::span<const Basin> basins, std::vector<Saddle> saddles,
                          const IslandLimits& limits) {
  std::vector<std::pair<std::int64_t, int>> numbers;  // of each id
  for (const Basin& basin : basins) numbers.emplace_back(basin.id, static_cast<int>(numbers.size()));
  std::sort(numbers.begin(), numbers.end());
  const auto number = [&](std::int64_t id) {
    return std::lower_bound(numbers.begin(), numbers.end(), std::pair(id, 0))->second;
  };
  std::sort(saddles.begin(), saddles.end(), [](const Saddle& a, const Saddle& b) {
    return std::tie(a.turn, a.kind) < std::tie(b.turn, b.kind);
  });
  MeetingBasins meeting(basins, limits);
  for (const Saddle& saddle : saddles) meeting.meet(saddle, number(saddle.basin), number(saddle.neighbor));
  meeting.end_components();
  return meeting.islands();
}

}  // namespace fabseq
