// SPDX-License-Identifier: MIT
#include "fabseq/optimize/run_cost.h"

#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/process/process_simulation.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/solve/reference/reference_elasticity.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fabseq {

namespace {

/// What a path needs, measured (docs/performance.md).
struct PathCost {
  double bytes_per_unknown;    ///< of a system with its preconditioner; with lanes, per lane
  double seconds_per_unknown;  ///< of a solve on one core
};
constexpr PathCost lanes_cost{121.0, 4.5e-7};
constexpr PathCost reference_cost{3000.0, 1e-5};
/// What the narrower solvers add to that of a lane, where there are any (LaneCycle::narrows).
constexpr double narrower_bytes_per_unknown = 69.0;
/// The heat problem's memory per node: per lane, and all in all on the reference path.
constexpr double heat_bytes_per_lane = 106.0, reference_heat_bytes = 700.0;
/// The reference path keeps the factors of every layer.
constexpr double factor_bytes_per_unknown = 5000.0;
/// A rank holds this much whatever it solves.
constexpr double bytes_per_rank = 8e7;

/// The forward heat solve, which one group does for all, in units of a full block of layers.
constexpr double forward_heat_work = 0.1;
/// What the first doubling of a group's ranks, and each further one, adds to its time: two ranks are 1.6
/// times as fast as one, four 2.4 times (docs/performance.md).
constexpr double overhead_of_the_first_doubling = 0.25;
constexpr double overhead_of_a_further_doubling = 0.35;

const PathCost& cost_of(SolverPath path) { return path == SolverPath::lanes ? lanes_cost : reference_cost; }

/// Time of a group of several ranks, over that of one rank with its share of the work.
double overhead(int domain_ranks) {
  if (domain_ranks == 1) return 1.0;
  return (1.0 + overhead_of_the_first_doubling) *
         std::pow(1.0 + overhead_of_a_further_doubling, std::log2(domain_ranks) - 1.0);
}

/// Counts the functionals of all terms that may be handed over as sums of squares, and the values of one that
/// is the largest of them.
template <int Dim>
int functional_count(const ModelSettings& settings, const Part<Dim>& part,
                     const std::map<std::string, NodeSet>& node_sets) {
  const ResponseContext<Dim> context{part, node_sets, 1.0};
  int result = 0;
  for (const Term& term : settings.objective) {
    const auto response = term.type->make(term, context);
    const auto functionals = response->squares(term.scaling);
    result += functionals ? functionals->count : 0;
    if (term.type->facts(term).is_largest) result += static_cast<int>(settings.material.scenarios.size());
  }
  return result;
}

}  // namespace

template <int Dim>
RunSize run_size(const ModelSettings& settings, const Part<Dim>& part,
                 const std::map<std::string, NodeSet>& node_sets, int layers, int ranks) {
  std::int64_t nodes = 0;
  for (std::size_t node = 0; node < part.touched_nodes().size(); ++node)
    nodes += part.touched_nodes()[node] != 0 || part.substrate().nodes()[node] != 0 ? 1 : 0;
  nodes = sum(part.grid().comm(), nodes);
  if (settings.process.void_model == VoidModel::quiet) nodes = part.grid().all_nodes().count();
  RunSize size;
  size.unknowns = static_cast<double>(nodes) * Dim;
  size.nodes = static_cast<double>(part.grid().all_nodes().count());
  size.part_elements = static_cast<double>(part.count());
  size.dimension = Dim;
  size.layers = layers;
  size.ranks = ranks;
  size.cases = static_cast<int>(strain_cases<Dim>(settings.material).cases.size());
  size.functionals = functional_count(settings, part, node_sets);
  return size;
}

BlockSolver block_solver(SolverPath path) {
  return path == SolverPath::lanes ? BlockSolver::lanes : BlockSolver::one_by_one;
}

double memory_estimate(const RunSize& size, SolverPath path, int groups, int lanes) {
  // Each group has the heat problem and all densities; increments and what counts of them, and gradients with
  // two rows per layer, are shared out. The baseline's report is there throughout, two others when there are
  // no gradients any more.
  const double problem = size.nodes * 200.0 * groups + size.part_elements * size.layers * 16.0 * groups;
  const double increments =
      size.unknowns * size.layers * 8.0 * (size.cases + 1.0 / static_cast<double>(size.dimension));
  const double gradients = size.part_elements * (24.0 * size.layers + 56.0 * size.functionals + 100.0);
  const double report = size.nodes * 136.0;
  const double held =
      problem + increments + report + std::max(gradients, 2.0 * report) + size.ranks * bytes_per_rank;
  if (path == SolverPath::reference) {
    const bool kept = size.unknowns <= static_cast<double>(ReferenceElasticity<3>::keep_limit);
    const double systems = size.unknowns * (kept ? size.layers * factor_bytes_per_unknown
                                                 : reference_cost.bytes_per_unknown * groups);
    return held + systems + size.nodes * reference_heat_bytes * groups;
  }
  // Load, solution and a copy with halo, of all nodes; then the lane engine's own.
  const double vectors = 24.0 * size.nodes * size.dimension * lanes * groups;
  // To save memory, there are no narrower solvers, and only one of both has its vectors at a time.
  const bool saves = lanes < ProcessSimulation<3>::most_lanes;
  const double of_lane = lanes_cost.bytes_per_unknown + (saves ? 0.0 : narrower_bytes_per_unknown);
  const double elasticity = vectors + of_lane * size.unknowns * lanes * groups;
  const double heat = heat_bytes_per_lane * size.nodes * lanes * groups;
  return held + (saves ? std::max(elasticity, heat) : elasticity + heat);
}

/// Fewer groups come before fewer lanes.
int wanted_lanes(const SolverSettings& settings) {
  return settings.lanes.value_or(ProcessSimulation<3>::most_lanes);
}

int resolved_lanes(MPI_Comm world, const SolverSettings& settings, const RunSize& size, int groups) {
  if (settings.lanes) return *settings.lanes;
  const double available = usable_memory * static_cast<double>(available_memory_bytes(world));
  int lanes = ProcessSimulation<3>::most_lanes;
  while (lanes > 1 && memory_estimate(size, settings.path, groups, lanes) > available) lanes /= 2;
  return lanes;
}

double relative_time_estimate(const RunSize& size, SolverPath path, int groups) {
  const std::vector<double> equal(size.layers, 1.0);
  const int domain_ranks = size.ranks / groups;
  const double work =
      forward_heat_work +
      deal_out_layers(equal, groups, ProcessSimulation<3>::most_lanes, block_solver(path)).longest;
  return work * overhead(domain_ranks) / domain_ranks;
}

double iteration_seconds_estimate(const RunSize& size, SolverPath path) {
  return (1.0 + size.cases + size.functionals) * size.layers * size.unknowns *
         cost_of(path).seconds_per_unknown / size.ranks;
}

FABSEQ_INSTANTIATE_FUNCTION(run_size);

}  // namespace fabseq
