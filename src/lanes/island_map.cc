// SPDX-License-Identifier: MIT
#include "fabseq/lanes/island_map.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

namespace {

/// Counts and starts of a list that every rank has a part of.
void measure(MPI_Comm comm, int own, std::vector<int>& counts, std::vector<int>& starts) {
  counts.resize(static_cast<std::size_t>(size_of(comm)));
  MPI_Allgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  starts.assign(counts.size() + 1, 0);
  std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
}

template <class Value>
std::vector<Value> gather(MPI_Comm comm, MPI_Datatype type, const std::vector<Value>& own,
                          const std::vector<int>& counts, const std::vector<int>& starts) {
  std::vector<Value> all(static_cast<std::size_t>(starts.back()));
  MPI_Allgatherv(own.data(), static_cast<int>(own.size()), type, all.data(), counts.data(), starts.data(),
                 type, comm);
  return all;
}

}  // namespace

template <int Dim>
IslandMap<Dim>::IslandMap(const LaneLevel<Dim>& level)
    : level_(level),
      node_held_(level.mesh.nodes(), 0),
      node_counted_(level.mesh.nodes(), 0),
      element_supported_(level.mesh.elements(), 0) {
  const std::int64_t nodes = level.mesh.nodes();
  const auto components = static_cast<std::int64_t>(Dim);
  for (const std::int64_t unknown : level.fixed) node_held_[unknown / components] = 1;
  for (const auto& range : level.counted)
    std::fill(node_counted_.begin() + range.begin, node_counted_.begin() + range.end, 1);
  for (const auto& row : level.mesh.rows())
    for (int i = 0; i < row.length; ++i)
      for (const std::int64_t first : row.node)
        if (node_held_[first + i] != 0 || node_held_[first + i + 1] != 0)
          element_supported_[row.element + i] = 1;

  const IndexBox<Dim> box{Index<Dim>{}, level.elements};
  IndexBox<Dim> node_box = box;
  for (int& extent : node_box.size) ++extent;
  if (node_box.count() > largest) return;
  places_.resize(static_cast<std::size_t>(level.mesh.elements()));
  level.mesh.element_box().for_each([&](const Index<Dim>& element, std::int64_t) {
    const int number = level.mesh.element_number(element);
    if (number >= 0) places_[number] = static_cast<int>(box.offset(element));
  });
  node_places_.resize(static_cast<std::size_t>(nodes));
  level.mesh.node_box().for_each([&](const Index<Dim>& node, std::int64_t) {
    const int number = level.mesh.node_number(node);
    if (number >= 0) node_places_[number] = static_cast<int>(node_box.offset(node));
  });
  measure(level.comm, static_cast<int>(places_.size()), element_counts_, element_starts_);
  measure(level.comm, static_cast<int>(node_places_.size()), node_counts_, node_starts_);
  all_places_ = gather(level.comm, MPI_INT, places_, element_counts_, element_starts_);
  all_node_places_ = gather(level.comm, MPI_INT, node_places_, node_counts_, node_starts_);
  all_supported_ = gather(level.comm, MPI_CHAR, element_supported_, element_counts_, element_starts_);
}

/// The number of islands, then for all ranks' nodes which they are on. Not collective.
template <int Dim>
std::vector<int> IslandMap<Dim>::find_in(std::span<const double> field) const {
  std::vector<double> stiffness(
      static_cast<std::size_t>(IndexBox<Dim>{Index<Dim>{}, level_.elements}.count()), 0.0);
  std::vector<char> supported(stiffness.size(), 0);
  for (std::size_t e = 0; e < field.size(); ++e) {
    stiffness[all_places_[e]] = field[e];
    supported[all_places_[e]] = all_supported_[e];
  }
  const StiffIslands islands = find_stiff_islands<Dim>(level_.elements, stiffness, supported);
  std::vector<int> result{islands.count};
  for (const int place : all_node_places_)
    result.push_back(islands.count > 0 ? islands.node_island[place] : -1);
  return result;
}

template <int Dim>
std::vector<LaneIslands> IslandMap<Dim>::find(std::span<const double> stiffness, int width) const {
  std::vector<LaneIslands> result(static_cast<std::size_t>(width));
  if (all_places_.empty()) return result;
  const int ranks = size_of(level_.comm), rank = rank_of(level_.comm);
  // All fields travel before the first is looked at: the ranks look at theirs at the same time.
  std::vector<std::vector<double>> fields(static_cast<std::size_t>(width));
  std::vector<double> own(places_.size());
  for (int lane = 0; lane < width; ++lane) {
    for (std::size_t e = 0; e < own.size(); ++e) own[e] = stiffness[e * width + lane];
    // The whole field on one rank, in the order of the ranks' elements.
    if (rank == lane % ranks) fields[lane].resize(all_places_.size());
    MPI_Gatherv(own.data(), static_cast<int>(own.size()), MPI_DOUBLE, fields[lane].data(),
                element_counts_.data(), element_starts_.data(), MPI_DOUBLE, lane % ranks, level_.comm);
  }
  std::vector<std::vector<int>> found(static_cast<std::size_t>(width));
  for (int lane = rank; lane < width; lane += ranks) found[lane] = find_in(fields[lane]);
  std::vector<int> node_island(node_places_.size());
  for (int lane = 0; lane < width; ++lane) {
    const int root = lane % ranks;
    LaneIslands& islands = result[lane];
    islands.count = rank == root ? found[lane][0] : 0;
    MPI_Bcast(&islands.count, 1, MPI_INT, root, level_.comm);
    if (islands.count == 0) continue;
    MPI_Scatterv(rank == root ? found[lane].data() + 1 : nullptr, node_counts_.data(), node_starts_.data(),
                 MPI_INT, node_island.data(), static_cast<int>(node_island.size()), MPI_INT, root,
                 level_.comm);
    for (std::size_t node = 0; node < node_island.size(); ++node)
      if (node_island[node] >= 0 && node_held_[node] == 0)
        islands.nodes.push_back(
            {static_cast<std::int64_t>(node), node_island[node], node_counted_[node] != 0});
  }
  return result;
}

FABSEQ_INSTANTIATE_CLASS(IslandMap);

}  // namespace fabseq
