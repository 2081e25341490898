// SPDX-License-Identifier: MIT
#include "fabseq/model/run_cost.h"

#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/model/stage_cost.h"
#include "fabseq/process/strain_cases.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fabseq {

namespace {

/// A rank holds this much whatever it solves.
constexpr double bytes_per_rank = 8e7;

/// What the first doubling of a group's ranks, and each further one, adds to its time: two ranks are 1.54
/// times as fast as one, four 2.3 times (docs/developer/measuring.md).
constexpr double overhead_of_the_first_doubling = 0.3;
constexpr double overhead_of_a_further_doubling = 0.35;

/// Time of a group of several ranks, over that of one rank with its share of the work.
double overhead(int domain_ranks) {
  if (domain_ranks == 1) return 1.0;
  return (1.0 + overhead_of_the_first_doubling) *
         std::pow(1.0 + overhead_of_a_further_doubling, std::log2(domain_ranks) - 1.0);
}

/// Counts the functionals of all terms that may be handed over as sums of squares, and the values of one that
/// is the largest of them.
template <int Dim>
int functional_count(const ModelSettings& settings, const ResponseList<Dim>& objective) {
  int result = 0;
  for (std::size_t i = 0; i < objective.size(); ++i) {
    const Term& term = settings.objective[i];
    const auto functionals = objective[i]->squares(term.scaling);
    result += functionals && takes_squares(settings, *functionals) ? functionals->count : 0;
    if (term.type->facts(term).is_largest) result += static_cast<int>(settings.material.scenarios.size());
  }
  return result;
}

}  // namespace

template <int Dim>
RunSize run_size(const ModelSettings& settings, const Part<Dim>& part, const ResponseList<Dim>& objective,
                 int layers, int ranks) {
  std::int64_t nodes = 0;
  for (std::size_t node = 0; node < part.touched_nodes().size(); ++node)
    nodes += part.touched_nodes()[node] != 0 || part.substrate().nodes()[node] != 0 ? 1 : 0;
  nodes = sum(part.grid().comm(), nodes);
  const std::int64_t solid_nodes = nodes;
  if (settings.process.void_model == VoidModel::quiet) nodes = part.grid().all_nodes().count();
  RunSize size;
  size.unknowns = static_cast<double>(nodes) * Dim;
  size.nodes = static_cast<double>(part.grid().all_nodes().count());
  size.part_elements = static_cast<double>(part.count());
  size.dimension = Dim;
  size.layers = layers;
  size.ranks = ranks;
  size.solid_nodes = static_cast<double>(solid_nodes);
  if (settings.thermal) {
    const ThermalProperties properties(*settings.thermal, settings.material, settings.process);
    size.temperature_steps = layers * properties.steps();
    size.curved_heat = !properties.constant();
  }
  size.flow_steps = flow_steps(settings, layers);
  size.warm = !settings.solver.tolerance;
  size.cases = static_cast<int>(strain_cases<Dim>(settings.material).cases.size());
  size.functionals = functional_count(settings, objective);
  return size;
}

int flow_steps(const ModelSettings& settings, int layers) {
  if (settings.process.model == ProcessModel::linear) return 0;
  return settings.thermal ? 2 * layers + 1 : layers;
}

BlockSolver block_solver(SolverPath path) {
  return path == SolverPath::lanes ? BlockSolver::lanes : BlockSolver::one_by_one;
}

bool saves_memory(int lanes) { return lanes < widest_block; }

double memory_estimate(const RunSize& size, SolverPath path, int groups, int lanes) {
  // Gradients with two rows per layer are shared out. The planar baseline's report is there throughout, two
  // others and two baselines when there are no gradients any more.
  const double gradients = size.part_elements * (24.0 * size.layers + 56.0 * size.functionals + 100.0);
  const double report = size.nodes * 136.0;
  double held = report + std::max(gradients, 4.0 * report) + size.ranks * bytes_per_rank;
  double all = 0.0, largest = 0.0;
  for (const NamedStageCost& stage : stage_costs()) {
    const StageCost cost = stage.of(size, path, groups, lanes);
    held += cost.held;
    all += cost.solving;
    largest = std::max(largest, cost.solving);
  }
  // To save memory, one stage at a time has its solver's vectors.
  return held + (path == SolverPath::lanes && saves_memory(lanes) ? largest : all);
}

/// Fewer groups come before fewer lanes.
int wanted_lanes(const SolverSettings& settings) { return settings.lanes.value_or(widest_block); }

int resolved_lanes(MPI_Comm world, const SolverSettings& settings, const RunSize& size, int groups) {
  if (settings.lanes) return *settings.lanes;
  const double available = usable_memory * static_cast<double>(available_memory_bytes(world));
  int lanes = widest_block;
  while (lanes > 1 && memory_estimate(size, settings.path, groups, lanes) > available) lanes /= 2;
  return lanes;
}

double relative_time_estimate(const RunSize& size, SolverPath path, int groups) {
  const int domain_ranks = size.ranks / groups;
  double slowest = 0.0, all = 0.0;
  for (const NamedStageCost& stage : stage_costs()) {
    const StageCost cost = stage.of(size, path, groups, widest_block);
    slowest += cost.work;
    all += cost.work + cost.work_of_other_groups;
  }
  // A rank has one core at most, and all ranks together have as many as there are: where ranks share cores,
  // groups that are done leave theirs to the others.
  const double cores = size.cores_per_rank * size.ranks;
  return overhead(domain_ranks) * std::max(slowest / domain_ranks, all / cores);
}

double iteration_seconds_estimate(const RunSize& size, SolverPath path) {
  double seconds = 0.0;
  for (const NamedStageCost& stage : stage_costs()) seconds += stage.of(size, path, 1, widest_block).seconds;
  return seconds / size.cores_per_rank;
}

FABSEQ_INSTANTIATE_FUNCTION(run_size);

}  // namespace fabseq
