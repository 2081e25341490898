// SPDX-License-Identifier: MIT
#include "fabseq/process/step_systems.h"

#include "process/last_solutions.h"
#include "process/solve_count.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace fabseq {

template <int Dim>
struct StepSystems<Dim>::Workspace {
  std::vector<LaneVector> loads, solutions;
  LaneVector scratch;
};

template <int Dim>
StepSystems<Dim>::StepSystems(const ElasticModel<Dim>& model, std::unique_ptr<ElasticitySolver<Dim>> solver,
                              const LayerGroups& groups, BlockSolver blocks, int lanes)
    : model_(model),
      groups_(groups),
      block_solver_(blocks),
      lanes_(lanes),
      elements_(model),
      solver_(std::move(solver)),
      last_(std::make_unique<LastSolutions>()),
      workspace_(std::make_unique<Workspace>()) {}

template <int Dim>
StepSystems<Dim>::~StepSystems() = default;

template <int Dim>
void StepSystems<Dim>::leave_out_unbuilt(bool built) {
  if (!built)
    built_.reset();
  else if (!built_)
    built_ = std::make_unique<const BuiltRegion<Dim>>(model_);
}

/// Expected iterations of the steps, in units of those with all elements, and one more, since a step takes
/// some time whatever its iterations. A single group is dealt all blocks whatever their work.
template <int Dim>
std::vector<double> StepSystems<Dim>::work_of(const LayerDensities& densities) const {
  const std::size_t steps = steps_.size();
  std::vector<double> work(steps, 1.0);
  for (std::size_t step = 0; expected_work_.size() == 2 * steps && step < steps; ++step)
    work[step] += expected_work_[step] + expected_work_[steps + step];
  if (!built_ || groups_.count() == 1) return work;
  const std::vector<double> shares = built_->standing_shares(densities);
  for (std::size_t step = 0; step < steps; ++step) work[step] *= shares[steps_[step].layer];
  return work;
}

template <int Dim>
void StepSystems<Dim>::deal_out(const LayerDensities& densities, std::vector<BuildStep> steps) {
  steps_ = std::move(steps);
  if (warm_ && warm_deal_ && warm_deal_->first == steps_.size()) {
    set_deal(warm_deal_->second);
    return;
  }
  set_deal(deal_out_steps(work_of(densities), groups_.count(), lanes_, block_solver_, layers_of_steps()));
  if (!warm_) return;
  last_->forget();
  warm_deal_ = {steps_.size(), deal_};
}

template <int Dim>
void StepSystems<Dim>::deal_out_in_turn(std::vector<BuildStep> steps) {
  steps_ = std::move(steps);
  set_deal(fabseq::deal_out_in_turn(steps_.size(), groups_.count(), lanes_, layers_of_steps()));
}

template <int Dim>
std::vector<int> StepSystems<Dim>::layers_of_steps() const {
  std::vector<int> result;
  for (const BuildStep& step : steps_) result.push_back(step.layer);
  return result;
}

template <int Dim>
void StepSystems<Dim>::set_deal(StepDeal deal) {
  deal_ = std::move(deal);
  blocks_.clear();
  for (const StepBlock& block : deal_.blocks[groups_.index()]) {
    const auto own = std::span(steps_).subspan(block.first, block.lanes);
    blocks_.push_back({block, {own.begin(), own.end()}});
  }
}

template <int Dim>
typename StepSystems<Dim>::Place StepSystems<Dim>::place_of(int step) const {
  for (int group = 0; group < groups_.count(); ++group)
    for (std::size_t block = 0; block < deal_.blocks[group].size(); ++block) {
      const int lane = step - deal_.blocks[group][block].first;
      if (lane >= 0 && lane < deal_.blocks[group][block].lanes) return {group, block, lane};
    }
  throw std::logic_error("a step that no group has");
}

template <int Dim>
std::vector<int> StepSystems<Dim>::solve(const LayerDensities& densities, SolvePurpose purpose,
                                         StepLoads& loads) {
  SolveCount count(steps_.size());
  groups_.run([&] {
    for (std::size_t block = 0; block < blocks_.size(); ++block)
      solve_block(densities, block, purpose, loads, count);
  });
  save_memory();
  count.gather(groups_);
  if (expected_work_.size() != 2 * count.all.size()) expected_work_.assign(2 * count.all.size(), 0.0);
  std::ranges::copy(count.all,
                    expected_work_.begin() + (purpose == SolvePurpose::adjoint ? std::ssize(count.all) : 0));
  return std::move(count.largest);
}

template <int Dim>
void StepSystems<Dim>::solve_block(const LayerDensities& densities, std::size_t block, SolvePurpose purpose,
                                   StepLoads& loads, SolveCount& iterations) {
  BlockRegion& region = blocks_[block];
  if (built_ && purpose == SolvePurpose::forward) region = built_->of(densities, region.block, region.steps);
  const std::size_t all = loads.begin(block);
  if (all == 0) return;
  (void)set_operators(densities, block, /*changed=*/purpose == SolvePurpose::forward);
  const std::size_t at_once = std::min(all, solver_->sets_at_once());
  Workspace& workspace = *workspace_;
  // Fresh memory costs more than what is done with it.
  if (workspace.loads.size() < at_once) workspace.loads.resize(at_once);
  if (workspace.solutions.size() < at_once) workspace.solutions.resize(at_once);
  for (std::size_t first = 0; first < all; first += at_once) {
    const std::size_t count = std::min(at_once, all - first);
    for (std::size_t i = 0; i < count; ++i) {
      resize(workspace.loads[i], owned_nodes(), Dim, region.block.lanes);
      resize(workspace.solutions[i], owned_nodes(), Dim, region.block.lanes);
      loads.set(block, first + i, workspace.loads[i]);
    }
    const auto loads_now = std::span(workspace.loads).first(count);
    const auto solutions = std::span(workspace.solutions).first(count);
    const auto reports = warm_ && all <= most_kept ? solve_warm(region, purpose, first, loads_now, solutions)
                                                   : solver_->solve(loads_now, solutions);
    for (std::size_t i = 0; i < count; ++i) {
      iterations.add(reports[i], region, purpose == SolvePurpose::adjoint ? "adjoint" : "forward");
      loads.take(block, first + i, workspace.solutions[i]);
    }
  }
  loads.end(block);
}

/// Solves for right-hand sides from number `first` on.
template <int Dim>
std::vector<std::vector<SolveReport>> StepSystems<Dim>::solve_warm(const BlockRegion& region,
                                                                   SolvePurpose purpose, std::size_t first,
                                                                   std::span<const LaneVector> loads,
                                                                   std::span<LaneVector> solutions) {
  const auto place = [&](std::size_t i) {
    return LastSolutions::Place{purpose == SolvePurpose::adjoint, region.block, first + i};
  };
  for (std::size_t i = 0; i < solutions.size(); ++i) last_->recall(place(i), model_.nodes, solutions[i]);
  auto reports = solver_->improve(loads, solutions);
  for (std::size_t i = 0; i < solutions.size(); ++i) last_->keep(place(i), model_.nodes, solutions[i]);
  return reports;
}

template <int Dim>
LaneVector& StepSystems<Dim>::scratch() {
  return workspace_->scratch;
}

template <int Dim>
void StepSystems<Dim>::save_memory() {
  if (!solver_->saves_memory()) return;
  solver_->release_memory();
  *workspace_ = {};
}

template <int Dim>
void StepSystems<Dim>::release_memory() {
  solver_->release_memory();
  *workspace_ = {};
  last_->forget();
}

template <int Dim>
void StepSystems<Dim>::start_cold() {
  solver_->start_cold();
  last_->forget();
  warm_deal_.reset();
}

template <int Dim>
std::vector<double> StepSystems<Dim>::set_operators(const LayerDensities& densities, std::size_t block,
                                                    bool changed, const ScaleStiffness& scale) {
  const BlockRegion& region = blocks_[block];
  std::vector<double> stiffness = elements_.stiffness(densities, region);
  if (scale) scale(region, stiffness);
  solver_->set_operators(region.block.first, region.block.lanes, stiffness, changed);
  return stiffness;
}

template <int Dim>
std::vector<SolveReport> StepSystems<Dim>::solve_current(std::size_t block, const LaneVector& load,
                                                         LaneVector& solution, const char* what) {
  const BlockRegion& region = blocks_[block];
  resize(solution, owned_nodes(), Dim, region.block.lanes);
  std::vector<SolveReport> reports = solver_->solve({&load, 1}, {&solution, 1}).front();
  SolveCount(steps_.size()).add(reports, region, what);
  return reports;
}

FABSEQ_INSTANTIATE_CLASS(StepSystems);

}  // namespace fabseq
