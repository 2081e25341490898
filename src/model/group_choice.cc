// SPDX-License-Identifier: MIT
#include "fabseq/model/group_choice.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/refusal.h"
#include "fabseq/grid/decomposition.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/model/run_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

/// Nodes between the ranks of a group, where the box is cut with the least surface.
template <int Dim>
double halo_nodes(const Index<Dim>& elements, int ranks) {
  double least = std::numeric_limits<double>::infinity();
  for (const Index<Dim>& processes : fitting_process_grids<Dim>(ranks, elements)) {
    double nodes = 0.0;
    for (int axis = 0; axis < Dim; ++axis) {
      double cut = processes[axis] - 1;
      for (int other = 0; other < Dim; ++other)
        if (other != axis) cut *= elements[other] + 1.0;
      nodes += cut;
    }
    least = std::min(least, nodes);
  }
  return std::isfinite(least) ? least : 0.0;
}

std::string groups_text(int groups, int ranks) {
  return std::to_string(groups) + " x " + std::to_string(ranks / groups);
}

/// Divisors of the number of ranks, ascending.
std::vector<int> possible_groups(int ranks) {
  std::vector<int> result;
  for (int groups = 1; groups <= ranks; ++groups)
    if (ranks % groups == 0) result.push_back(groups);
  return result;
}

/// Groups that are worth it at most. Where material flows, waves of more steps take more sweeps: two groups
/// of a rank take 1.3 times as long as one of two ranks (docs/developer/experiments.md).
int most_groups(const RunSize& size) { return size.flow_steps > 0 ? 1 : size.layers; }

template <int Dim>
std::string explain(const ModelSettings& settings, const RunSize& size, int groups, double available,
                    std::optional<int> fastest) {
  const SolverPath path = settings.solver.path;
  const int lanes = wanted_lanes(settings.solver);
  RunSize alone = size;
  alone.ranks = 1;
  alone.cores_per_rank = 1.0;
  const auto speedup = [&](int of_groups) {
    return relative_time_estimate(alone, path, 1) / relative_time_estimate(size, path, of_groups);
  };
  const double halo = halo_nodes<Dim>(settings.domain<Dim>().elements, size.ranks) -
                      halo_nodes<Dim>(settings.domain<Dim>().elements, size.ranks / groups);
  std::string result = formatted(
      "layer groups: %s ranks (auto): %.1f times as fast as one rank by the model, %s ranks %.1f times; "
      "memory estimate %.2f GB of %.2f GB available; halo saved %.2f MB a product with all layers' matrices",
      groups_text(groups, size.ranks).c_str(), speedup(groups), groups_text(1, size.ranks).c_str(),
      speedup(1), memory_estimate(size, path, groups, lanes) / 1e9, available / 1e9,
      2.0 * halo * Dim * size.layers * sizeof(double) / 1e6);
  if (size.cores_per_rank < 1.0) result += formatted("; %.2g cores a rank", size.cores_per_rank);
  if (fastest && *fastest != groups)
    result +=
        formatted("; %s ranks would be faster, but need %.2f GB", groups_text(*fastest, size.ranks).c_str(),
                  memory_estimate(size, path, *fastest, lanes) / 1e9);
  return result;
}

}  // namespace

GroupChoice asked_choice(int groups, int ranks) {
  if (ranks % groups != 0) {
    std::vector<std::string> allowed;
    for (const int possible : possible_groups(ranks)) allowed.push_back(std::to_string(possible));
    refuse("/solver/layer_groups",
           std::to_string(groups) + " on " + std::to_string(ranks) + (ranks == 1 ? " rank" : " ranks"),
           "\"auto\" or a divisor of the number of ranks (" + join(allowed, ", ") + ")");
  }
  return {groups, ranks > 1 ? "layer groups: " + groups_text(groups, ranks) + " ranks" : ""};
}

/// The fastest choice that fits; without one that does, a single group, which needs least.
template <int Dim>
GroupChoice fastest_choice(const ModelSettings& settings, const RunSize& size, double available) {
  std::optional<int> best, fastest;
  const auto is_faster = [&](int groups, const std::optional<int>& other) {
    return !other || relative_time_estimate(size, settings.solver.path, groups) <
                         relative_time_estimate(size, settings.solver.path, *other);
  };
  for (const int groups : possible_groups(size.ranks)) {
    if (groups > most_groups(size)) break;
    if (is_faster(groups, fastest)) fastest = groups;
    const bool fits = memory_estimate(size, settings.solver.path, groups, wanted_lanes(settings.solver)) <=
                      usable_memory * available;
    if (fits && is_faster(groups, best)) best = groups;
  }
  const int groups = best.value_or(1);
  return {groups, explain<Dim>(settings, size, groups, available, fastest)};
}

template <int Dim>
GroupChoice likely_choice(const ModelSettings& settings, int ranks, double cores_per_rank, double available) {
  RunSize least;
  least.nodes = 1.0;
  for (const int elements : settings.domain<Dim>().elements) least.nodes *= elements + 1.0;
  least.dimension = Dim;
  least.layers = settings.layers.count.value_or(ranks * widest_block);
  least.flow_steps = flow_steps(settings, least.layers);
  least.ranks = ranks;
  least.cores_per_rank = cores_per_rank;
  return {fastest_choice<Dim>(settings, least, available).groups, ""};
}

FABSEQ_INSTANTIATE_FUNCTION(fastest_choice);
FABSEQ_INSTANTIATE_FUNCTION(likely_choice);

}  // namespace fabseq
