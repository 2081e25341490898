// SPDX-License-Identifier: MIT
#include "fabseq/optimize/run_cost.h"

#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/config/schema.h"
#include "fabseq/process/process_simulation.h"
#include "fabseq/responses/distortion_functionals.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "fabseq/solve/reference/reference_elasticity.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>
#include <vector>

namespace fabseq {

namespace {

/// What a path needs, measured (docs/performance.md).
struct PathCost {
  double bytes_per_unknown;  ///< of a system with its preconditioner: of the reference path; of the lanes, a
                             ///< lane
  double seconds_per_unknown;  ///< of a solve on one core
};
constexpr PathCost lanes_cost{121.0, 4.5e-7};
constexpr PathCost reference_cost{3000.0, 1e-5};
/// Of the heat problem, a node and lane; of the reference path, all in all.
constexpr double heat_bytes_per_lane = 106.0, reference_heat_bytes = 700.0;
/// Of the reference path's factors, which are kept a layer.
constexpr double factor_bytes_per_unknown = 5000.0;
/// That a rank holds anyway.
constexpr double bytes_per_rank = 8e7;

/// The forward heat solve, which one group does for all, in units of a full block of layers.
constexpr double forward_heat_work = 0.1;
/// What the first doubling of a group's ranks, and each further one, adds to its time: two ranks are 1.6
/// times as fast as one, four 2.4 times (docs/performance.md).
constexpr double overhead_of_the_first_doubling = 0.25;
constexpr double overhead_of_a_further_doubling = 0.35;
/// Share of the available memory that a choice may fill.
constexpr double usable_memory = 0.8;

const PathCost& cost_of(SolverPath path) { return path == SolverPath::lanes ? lanes_cost : reference_cost; }

/// Time of a group of several ranks, over that of one rank with its share of the work.
double overhead(int domain_ranks) {
  if (domain_ranks == 1) return 1.0;
  return (1.0 + overhead_of_the_first_doubling) *
         std::pow(1.0 + overhead_of_a_further_doubling, std::log2(domain_ranks) - 1.0);
}

/// Time of a design iteration, in units of a full block of layers on one rank.
double time_estimate(const RunSize& size, SolverPath path, int groups) {
  const std::vector<double> equal(size.layers, 1.0);
  const int domain_ranks = size.ranks / groups;
  const double work =
      forward_heat_work +
      deal_out_layers(equal, groups, ProcessSimulation<3>::most_lanes, block_solver(path)).longest;
  return work * overhead(domain_ranks) / domain_ranks;
}

/// Nodes between the ranks of a group, where the box is cut with the least surface.
template <int Dim>
double halo_nodes(const Index<Dim>& elements, int ranks) {
  double least = std::numeric_limits<double>::infinity();
  for (const Index<Dim>& processes : fitting_process_grids<Dim>(ranks, elements)) {
    double nodes = 0.0;
    for (int axis = 0; axis < Dim; ++axis) {
      double cut = processes[axis] - 1;
      for (int other = 0; other < Dim; ++other)
        if (other != axis) cut *= elements[other] + 1;
      nodes += cut;
    }
    least = std::min(least, nodes);
  }
  return std::isfinite(least) ? least : 0.0;
}

/// Of all terms that may be handed over as sums of squares.
template <int Dim>
int functional_count(const Config& config, const Part<Dim>& part) {
  std::map<std::string, NodeSet> node_sets;
  const ResponseContext<Dim> context{part, node_sets, 1.0};
  int result = 0;
  for (const ObjectiveTerm& term : config.objective) {
    if (!term.may_be_squares()) continue;
    if (const auto set = config.node_sets.find(term.nodes); set != config.node_sets.end())
      node_sets.try_emplace(term.nodes, make_node_set(part, term.nodes, set->second));
    const auto functionals = make_functionals<Dim>(term, context);
    result += functionals ? functionals->count() : 0;
  }
  return result;
}

std::string groups_text(int groups, int ranks) {
  return std::to_string(groups) + " x " + std::to_string(ranks / groups);
}

/// Fewer groups come before fewer lanes.
int wanted_lanes(const Config& config) {
  return config.solver.lanes.value_or(ProcessSimulation<3>::most_lanes);
}

/// Divisors of the number of ranks, ascending.
std::vector<int> possible_groups(int ranks) {
  std::vector<int> result;
  for (int groups = 1; groups <= ranks; ++groups)
    if (ranks % groups == 0) result.push_back(groups);
  return result;
}

template <int Dim>
std::string explain(const Config& config, const RunSize& size, int groups, double available,
                    std::optional<int> fastest) {
  const SolverPath path = config.solver.path;
  const int lanes = wanted_lanes(config);
  RunSize alone = size;
  alone.ranks = 1;
  const double halo = halo_nodes<Dim>(config.domain<Dim>().elements, size.ranks) -
                      halo_nodes<Dim>(config.domain<Dim>().elements, size.ranks / groups);
  char text[400];
  std::snprintf(text, sizeof text,
                "layer groups: %s ranks (auto): %.1f times as fast as one rank by the model, %s ranks %.1f "
                "times; memory estimate %.2f GB of %.2f GB available; halo saved %.2f MB a product with all "
                "layers' matrices",
                groups_text(groups, size.ranks).c_str(),
                time_estimate(alone, path, 1) / time_estimate(size, path, groups),
                groups_text(1, size.ranks).c_str(),
                time_estimate(alone, path, 1) / time_estimate(size, path, 1),
                memory_estimate(size, path, groups, lanes) / 1e9, available / 1e9,
                2.0 * halo * Dim * size.layers * sizeof(double) / 1e6);
  std::string result = text;
  if (fastest && *fastest != groups) {
    std::snprintf(text, sizeof text, "; %s ranks would be faster, but need %.2f GB",
                  groups_text(*fastest, size.ranks).c_str(),
                  memory_estimate(size, path, *fastest, lanes) / 1e9);
    result += text;
  }
  return result;
}

/// The fastest choice that fits; without one that does, a single group, which needs least.
template <int Dim>
GroupChoice choose_automatically(const Config& config, const RunSize& size, double available) {
  std::optional<int> best, fastest;
  const auto is_faster = [&](int groups, const std::optional<int>& other) {
    return !other ||
           time_estimate(size, config.solver.path, groups) < time_estimate(size, config.solver.path, *other);
  };
  for (const int groups : possible_groups(size.ranks)) {
    if (groups > size.layers) break;
    if (is_faster(groups, fastest)) fastest = groups;
    const bool fits =
        memory_estimate(size, config.solver.path, groups, wanted_lanes(config)) <= usable_memory * available;
    if (fits && is_faster(groups, best)) best = groups;
  }
  const int groups = best.value_or(1);
  return {groups, explain<Dim>(config, size, groups, available, fastest)};
}

/// Of all sub-parts: one alone has the whole part's, several overlap by a half each, as seen with two to
/// four.
int estimated_slabs(const MultiPlanarSettings& settings, double longest_edge) {
  const double slabs = std::ceil(longest_edge / settings.thickness) * (1.0 + settings.subparts) / 2.0;
  if (slabs + settings.subparts <= most_layers) return static_cast<int>(slabs) + settings.subparts;
  refuse("/layers/thickness", shown(settings.thickness) + " for a part " + shown(longest_edge) + " long",
         "at most " + std::to_string(most_layers) + " layers");
}

}  // namespace

template <int Dim>
RunSize run_size(const Config& config, const Part<Dim>& part, int layers, int ranks) {
  std::int64_t nodes = 0;
  for (std::size_t node = 0; node < part.touched_nodes().size(); ++node)
    nodes += part.touched_nodes()[node] != 0 || part.substrate().nodes()[node] != 0 ? 1 : 0;
  nodes = sum(part.grid().comm(), nodes);
  if (config.process.void_model == VoidModel::quiet) nodes = part.grid().all_nodes().count();
  RunSize size;
  size.unknowns = static_cast<double>(nodes) * Dim;
  size.nodes = static_cast<double>(part.grid().all_nodes().count());
  size.part_elements = static_cast<double>(part.count());
  size.dimension = Dim;
  size.layers = layers;
  size.ranks = ranks;
  size.functionals = functional_count(config, part);
  return size;
}

int layers_of_target(const Config& config, double height, double rounded) {
  if (rounded <= most_layers) return std::max(1, static_cast<int>(rounded));
  std::size_t index = 0;
  while (config.constraints[index].type != "layer_thickness") ++index;
  refuse("/constraints/" + std::to_string(index) + "/target",
         shown(*config.target_thickness()) + " for a height of " + shown(height),
         "at least " + shown(height / most_layers) + ", that is up to " + std::to_string(most_layers) +
             " layers");
}

template <int Dim>
int resolved_layer_count(const Config& config, const Part<Dim>& part) {
  if (config.layers.count) return *config.layers.count;
  if (config.layers.multi_planar) return estimated_slabs(*config.layers.multi_planar, part.longest_edge());
  const double height = geodesic_height(part, geodesic_distance(part));
  // A height that is a whole number of layers but for rounding needs no further one.
  return layers_of_target(config, height, std::ceil(height / *config.target_thickness() - 1e-9));
}

BlockSolver block_solver(SolverPath path) {
  return path == SolverPath::lanes ? BlockSolver::lanes : BlockSolver::one_by_one;
}

double memory_estimate(const RunSize& size, SolverPath path, int groups, int lanes) {
  // Each group has the heat problem and all densities; displacements and derivatives are shared out.
  const double of_nodes = size.nodes * (200.0 * groups + 8.0 * size.dimension * size.layers);
  const double of_elements =
      size.part_elements * size.layers * (16.0 * groups + 70.0 + 16.0 * size.functionals);
  const double held = of_nodes + of_elements + size.ranks * bytes_per_rank;
  if (path == SolverPath::reference) {
    const bool kept = size.unknowns <= static_cast<double>(ReferenceElasticity<3>::keep_limit);
    const double systems = size.unknowns * (kept ? size.layers * factor_bytes_per_unknown
                                                 : reference_cost.bytes_per_unknown * groups);
    return held + systems + size.nodes * reference_heat_bytes * groups;
  }
  // Load, solution and a copy with halo, of all nodes; then the lane engine's own.
  const double vectors = 24.0 * size.nodes * size.dimension * lanes * groups;
  const double elasticity = vectors + lanes_cost.bytes_per_unknown * size.unknowns * lanes * groups;
  const double heat = heat_bytes_per_lane * size.nodes * lanes * groups;
  const bool rests = lanes < ProcessSimulation<3>::most_lanes;  // the solvers, by turns
  return held + (rests ? std::max(elasticity, heat) : elasticity + heat);
}

int resolved_lanes(MPI_Comm world, const Config& config, const RunSize& size, int groups) {
  if (config.solver.lanes) return *config.solver.lanes;
  const double available = usable_memory * static_cast<double>(available_memory_bytes(world));
  int lanes = ProcessSimulation<3>::most_lanes;
  while (lanes > 1 && memory_estimate(size, config.solver.path, groups, lanes) > available) lanes /= 2;
  return lanes;
}

double iteration_seconds_estimate(const RunSize& size, SolverPath path) {
  return (2.0 + size.functionals) * size.layers * size.unknowns * cost_of(path).seconds_per_unknown /
         size.ranks;
}

template <int Dim>
GroupChoice choose_layer_groups(MPI_Comm world, const Config& config) {
  const int ranks = size_of(world);
  if (const std::optional<int> asked = config.solver.layer_groups) {
    if (ranks % *asked != 0) {
      std::vector<std::string> allowed;
      for (const int groups : possible_groups(ranks)) allowed.push_back(std::to_string(groups));
      refuse("/solver/layer_groups",
             std::to_string(*asked) + " on " + std::to_string(ranks) + (ranks == 1 ? " rank" : " ranks"),
             "\"auto\" or a divisor of the number of ranks (" + join(allowed, ", ") + ")");
    }
    return {*asked, ranks > 1 ? "layer groups: " + groups_text(*asked, ranks) + " ranks" : ""};
  }
  if (ranks == 1) return {};
  // Number of layers and size of the systems are known once there is a part: this one is for that only.
  PartDescription description = config.part;
  description.announce = false;
  const Grid<Dim> grid = make_balanced_grid(world, config.domain<Dim>(), description);
  const Part<Dim> part(grid, description, config.plate);
  const RunSize size = run_size(config, part, resolved_layer_count(config, part), ranks);
  return choose_automatically<Dim>(config, size, static_cast<double>(available_memory_bytes(world)));
}

#define FABSEQ_INSTANTIATE(Dim)                                              \
  template RunSize run_size<Dim>(const Config&, const Part<Dim>&, int, int); \
  template int resolved_layer_count<Dim>(const Config&, const Part<Dim>&);   \
  template GroupChoice choose_layer_groups<Dim>(MPI_Comm, const Config&);
FABSEQ_INSTANTIATE(2)
FABSEQ_INSTANTIATE(3)
#undef FABSEQ_INSTANTIATE

}  // namespace fabseq
