// SPDX-License-Identifier: MIT
#include "islands/island_map.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/mpi_struct.h"
#include "islands/local_basins.h"

#include <algorithm>
#include <limits>

namespace fabseq {

namespace {

/// Lists of one kind for each lane, [lane], to the ranks that look at the lanes, and from there to all.
template <class Item>
std::vector<std::vector<Item>> to_ranks_of_lanes(MPI_Comm comm, const std::vector<std::vector<Item>>& lists) {
  std::vector<std::vector<Item>> outgoing(static_cast<std::size_t>(size_of(comm)));
  for (std::size_t lane = 0; lane < lists.size(); ++lane) {
    std::vector<Item>& list = outgoing[lane % outgoing.size()];
    list.insert(list.end(), lists[lane].begin(), lists[lane].end());
  }
  return exchange_lists(comm, outgoing);
}

}  // namespace

template <int Dim>
IslandMap<Dim>::IslandMap(const LaneLevel<Dim>& level)
    : level_(level),
      whole_{Index<Dim>{}, level.elements},
      owned_(level.mesh.element_box()),
      ring_(level.comm, owned_, ringed(owned_)),
      places_(static_cast<std::size_t>(level.mesh.elements())),
      node_held_(level.mesh.nodes(), 0),
      node_counted_(level.mesh.nodes(), 0),
      supported_(static_cast<std::size_t>(owned_.count()), 0) {
  for (const std::int64_t unknown : level.fixed) node_held_[unknown / Dim] = 1;
  for (const auto& range : level.counted)
    std::fill(node_counted_.begin() + range.begin, node_counted_.begin() + range.end, 1);
  owned_.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    const int number = level.mesh.element_number(element);
    if (number < 0) return;
    places_[number] = ring_.wanted().offset(element);
    for (int corner = 0; corner < corner_count<Dim>; ++corner)
      if (node_held_[level.mesh.node_number(stepped<Dim>(element, corner, 1))] != 0) supported_[offset] = 1;
  });
}

template <int Dim>
std::vector<IslandLimits> IslandMap<Dim>::limits_of(std::span<const double> stiffness, int width,
                                                    double contrast, int most) const {
  std::vector<double> extremes(2 * static_cast<std::size_t>(width), 0.0);  // -least, largest: of each lane
  for (int lane = 0; lane < width; ++lane) extremes[2 * lane] = -std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    if (!(stiffness[i] > 0.0)) continue;
    double* extreme = &extremes[2 * (i % width)];
    extreme[0] = std::max(extreme[0], -stiffness[i]);
    extreme[1] = std::max(extreme[1], stiffness[i]);
  }
  max_in_place(level_.comm, extremes);
  std::vector<IslandLimits> limits;
  for (int lane = 0; lane < width; ++lane)
    limits.emplace_back(-extremes[2 * lane], extremes[2 * lane + 1], contrast, most);
  return limits;
}

/// A lane's stiffness on the ring. Where there are no elements, the field stays as it is.
template <int Dim>
void IslandMap<Dim>::set_field(std::span<const double> stiffness, int width, int lane,
                               std::vector<double>& field) const {
  for (std::size_t number = 0; number < places_.size(); ++number)
    field[places_[number]] = stiffness[number * width + lane];
  ring_.gather_others(
      [&](const Index<Dim>& element) {
        const int number = level_.mesh.element_number(element);
        return number < 0 ? 0.0 : stiffness[static_cast<std::size_t>(number) * width + lane];
      },
      field);
}

template <int Dim>
typename IslandMap<Dim>::Found IslandMap<Dim>::find_basins(std::span<const double> stiffness,
                                                           const std::vector<IslandLimits>& limits) const {
  const int width = static_cast<int>(limits.size());
  Found found;
  std::vector<double> values = empty_field();
  std::vector<std::int64_t> ids(values.size(), -1);  // of other ranks' elements
  for (int lane = 0; lane < width; ++lane) {
    set_field(stiffness, width, lane, values);
    const typename LocalBasins<Dim>::Field field{whole_, owned_, values, supported_};
    LocalBasins<Dim> local(field, limits[lane], rank_of(level_.comm));
    ring_.gather_others(
        [&](const Index<Dim>& element) {
          const int basin = local.of_element()[owned_.offset(element)];
          return basin < 0 ? std::int64_t{-1} : local.basins()[basin].id;
        },
        ids);
    found.saddles.push_back(local.saddles(ids));
    found.numbers.push_back(local.candidates(found.saddles.back()));
    auto& basins = found.basins.emplace_back();
    for (const int number : found.numbers.back()) {
      basins.push_back(local.basins()[number]);
      basins.back().lane = lane;
    }
    for (Saddle& saddle : found.saddles.back()) saddle.lane = lane;
    found.of_element.push_back(local.take_elements());
  }
  return found;
}

/// Islands of each lane: their number, and those of Found::basins.
template <int Dim>
std::vector<BasinIslands> IslandMap<Dim>::resolve(const Found& found,
                                                  const std::vector<IslandLimits>& limits) const {
  const auto basins = to_ranks_of_lanes(level_.comm, found.basins);
  const auto saddles = to_ranks_of_lanes(level_.comm, found.saddles);
  const int ranks = size_of(level_.comm), lanes = static_cast<int>(limits.size());
  std::vector<std::vector<int>> answers(static_cast<std::size_t>(ranks));  // in the order of `basins`
  std::vector<int> counts(limits.size(), 0);
  for (int lane = rank_of(level_.comm); lane < lanes; lane += ranks) {
    std::vector<Basin> all_basins;
    std::vector<Saddle> all_saddles;
    const auto in_lane = [lane](const auto& item) { return item.lane == lane; };
    for (const auto& list : basins)
      std::copy_if(list.begin(), list.end(), std::back_inserter(all_basins), in_lane);
    for (const auto& list : saddles)
      std::copy_if(list.begin(), list.end(), std::back_inserter(all_saddles), in_lane);
    const BasinIslands islands = find_islands(all_basins, std::move(all_saddles), limits[lane]);
    counts[lane] = islands.count;
    auto next = islands.of_basin.begin();
    for (int rank = 0; rank < ranks; ++rank) {
      const auto count = std::count_if(basins[rank].begin(), basins[rank].end(), in_lane);
      answers[rank].insert(answers[rank].end(), next, next + count);
      next += count;
    }
  }
  sum_in_place(level_.comm, counts);
  const auto answered = exchange_lists(level_.comm, answers);
  std::vector<std::size_t> used(answered.size(), 0);
  std::vector<BasinIslands> result(limits.size());
  for (int lane = 0; lane < lanes; ++lane) {
    result[lane].count = counts[lane];
    const int rank = lane % ranks;
    const auto first = answered[rank].begin() + static_cast<std::ptrdiff_t>(used[rank]);
    used[rank] += found.basins[lane].size();
    result[lane].of_basin.assign(first, first + static_cast<std::ptrdiff_t>(found.basins[lane].size()));
  }
  return result;
}

/// `island_of_element`: on the ring, as `field`.
template <int Dim>
std::vector<LaneIslands::Node> IslandMap<Dim>::nodes_of(const std::vector<double>& field,
                                                        const std::vector<int>& island_of_element) const {
  std::vector<LaneIslands::Node> result;
  level_.mesh.node_box().for_each([&](const Index<Dim>& index, std::int64_t) {
    const int node = level_.mesh.node_number(index);
    if (node < 0 || node_held_[node] != 0) return;
    double stiffest = 0.0;
    int island = -1;
    for (int number = corner_count<Dim> - 1; number >= 0; --number) {  // ascending elements
      const std::int64_t element = ring_.wanted().offset(stepped<Dim>(index, number, -1));
      if (!(field[element] > stiffest)) continue;  // so, what is no number counts as nothing
      stiffest = field[element];
      island = island_of_element[element];
    }
    if (island >= 0) result.push_back({node, island, node_counted_[node] != 0});
  });
  return result;
}

template <int Dim>
std::vector<LaneIslands> IslandMap<Dim>::find(std::span<const double> stiffness, int width, double contrast,
                                              int most) const {
  const std::vector<IslandLimits> limits = limits_of(stiffness, width, contrast, most);
  const Found found = find_basins(stiffness, limits);
  const std::vector<BasinIslands> islands = resolve(found, limits);
  std::vector<LaneIslands> result(static_cast<std::size_t>(width));
  std::vector<double> field;
  for (int lane = 0; lane < width; ++lane) {
    result[lane].count = islands[lane].count;
    if (islands[lane].count == 0) continue;
    if (field.empty()) field = empty_field();
    set_field(stiffness, width, lane, field);
    std::vector<int> of_basin;  // up to the last that may be one
    for (std::size_t i = 0; i < found.numbers[lane].size(); ++i) {
      of_basin.resize(std::max<std::size_t>(of_basin.size(), found.numbers[lane][i] + 1), -1);
      of_basin[found.numbers[lane][i]] = islands[lane].of_basin[i];
    }
    const auto island = ring_.template gather<int>(
        [&](const Index<Dim>& element) {
          const int basin = found.of_element[lane][owned_.offset(element)];
          return basin < 0 || basin >= static_cast<int>(of_basin.size()) ? -1 : of_basin[basin];
        },
        -1);
    result[lane].nodes = nodes_of(field, island);
  }
  return result;
}

FABSEQ_INSTANTIATE_CLASS(IslandMap);

}  // namespace fabseq
