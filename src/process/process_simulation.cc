// SPDX-License-Identifier: MIT
#include "fabseq/process/process_simulation.h"

#include "process/case_strain.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace fabseq {

template <int Dim>
ProcessSimulation<Dim>::ProcessSimulation(const ElasticModel<Dim>& model,
                                          std::unique_ptr<ElasticitySolver<Dim>> solver,
                                          const LayerGroups& groups, BlockSolver blocks, int lanes)
    : model_(model),
      groups_(groups),
      block_solver_(blocks),
      lanes_(lanes),
      cases_(strain_cases<Dim>(model.material)),
      elements_(model),
      supports_(model),
      adjoint_loads_(model, elements_, groups),
      solver_(std::move(solver)) {
  result_.all_layers = groups.world();
  result_.scenarios = cases_.scenarios;
  result_.other_cases.resize(cases_.cases.size() - 1);
  if (model.settings.deposition == DepositionModel::nominal)
    deposition_ = std::make_unique<const Deposition<Dim>>(model);
}

template <int Dim>
void ProcessSimulation<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  solver_->set_tolerance(tolerance);
  if (release_) release_->set_tolerance(tolerance.value);
}

template <int Dim>
void ProcessSimulation<Dim>::start_cold() {
  solver_->start_cold();
  if (release_) release_->start_cold();
}

template <int Dim>
void ProcessSimulation<Dim>::leave_out_unbuilt(bool built) {
  if (!built)
    built_.reset();
  else if (!built_)
    built_ = std::make_unique<const BuiltRegion<Dim>>(model_);
}

template <int Dim>
int ProcessSimulation<Dim>::owned_nodes() const {
  return static_cast<int>(model_.part.grid().owned_nodes().count());
}

template <int Dim>
void ProcessSimulation<Dim>::release_memory() {
  solver_->release_memory();
  for (std::size_t number = 0; number < result_.case_count(); ++number)
    result_.of_case(number).increments = {};
  result_.weights = {};
}

template <int Dim>
void ProcessSimulation<Dim>::set_operators(const LayerDensities& densities, const BlockRegion& region,
                                           bool changed) {
  solver_->set_operators(region.block.first, region.block.lanes, elements_.stiffness(densities, region),
                         changed);
}

/// Expected iterations of the layers, in units of those with all elements, and one more, since a layer takes
/// some time whatever its iterations. A single group is dealt all blocks whatever their work.
template <int Dim>
std::vector<double> ProcessSimulation<Dim>::work_of(const LayerDensities& densities) const {
  const auto layers = static_cast<std::size_t>(densities.count());
  std::vector<double> work(layers, 1.0);
  for (std::size_t layer = 0; expected_work_.size() == 2 * layers && layer < layers; ++layer)
    work[layer] += expected_work_[layer] + expected_work_[layers + layer];
  if (!built_ || groups_.count() == 1) return work;
  const std::vector<double> shares = built_->standing_shares(densities);
  for (std::size_t layer = 0; layer < work.size(); ++layer) work[layer] *= shares[layer];
  return work;
}

template <int Dim>
void ProcessSimulation<Dim>::expect(const std::vector<int>& work, bool adjoint) {
  if (expected_work_.size() != 2 * work.size()) expected_work_.assign(2 * work.size(), 0.0);
  std::ranges::copy(work, expected_work_.begin() + (adjoint ? std::ssize(work) : 0));
}

template <int Dim>
const ProcessResult& ProcessSimulation<Dim>::simulate(const LayerDensities& densities,
                                                      const StrainSource<Dim>& strains) {
  strains_ = &strains;
  deal_ = deal_out_layers(work_of(densities), groups_.count(), lanes_, block_solver_);
  result_.blocks = deal_.blocks[groups_.index()];
  regions_.clear();
  result_.nodes.clear();
  for (std::size_t number = 0; number < result_.case_count(); ++number) {
    result_.of_case(number).displacement.assign(model_.domain.fixed.size(), 0.0);
    result_.of_case(number).increments.resize(result_.blocks.size());
  }
  result_.weights.resize(deposition_ ? result_.blocks.size() : 0);
  SolveCount count(densities.count());
  groups_.run([&] {
    Workspace workspace(count);
    for (std::size_t number = 0; number < result_.blocks.size(); ++number) {
      const LayerBlock& block = result_.blocks[number];
      regions_.push_back(built_ ? built_->of(densities, block) : BlockRegion{block, {}, {}});
      result_.nodes.emplace_back(regions_.back().elements.empty() ? model_.nodes : regions_.back().nodes);
      solve_block(densities, number, workspace);
    }
  });
  if (solver_->saves_memory()) solver_->release_memory();
  for (std::size_t number = 0; number < result_.case_count(); ++number)
    groups_.sum(result_.of_case(number).displacement);
  count.gather(groups_);
  expect(count.all, /*adjoint=*/false);
  result_.iterations = std::move(count.largest);
  for (std::size_t number = 0; release_ && number < result_.case_count(); ++number) {
    const std::vector<double> forces = reactions(densities, number);
    result_.of_case(number).release = in_first_group([&] { return release_->displacement(forces); });
  }
  return result_;
}

template <int Dim>
std::vector<double> ProcessSimulation<Dim>::reactions(const LayerDensities& densities,
                                                      std::size_t number) const {
  std::vector<double> result(model_.domain.fixed.size(), 0.0);
  LaneVector increments;
  for (std::size_t block = 0; block < result_.blocks.size(); ++block) {
    spread(result_.of_case(number).increments[block], result_.nodes[block], owned_nodes(), increments);
    supports_.add_reactions(densities, CaseStrain<Dim>(*strains_, cases_.cases[number]), regions_[block],
                            increments, result);
  }
  groups_.sum(result);
  return result;
}

template <int Dim>
std::vector<double> ProcessSimulation<Dim>::in_first_group(
    const std::function<std::vector<double>()>& solve) {
  std::vector<double> result(model_.domain.fixed.size());
  groups_.run([&] {
    if (groups_.index() == 0) result = solve();
  });
  groups_.broadcast(0, result);
  return result;
}

/// All cases, as many at a time as the solver can use.
template <int Dim>
void ProcessSimulation<Dim>::solve_block(const LayerDensities& densities, std::size_t number,
                                         Workspace& workspace) {
  const LayerBlock& block = result_.blocks[number];
  set_operators(densities, regions_[number], true);
  const std::size_t all = result_.case_count(), at_once = std::min(all, solver_->sets_at_once());
  workspace.loads.resize(at_once);
  workspace.solutions.resize(at_once);
  for (std::size_t first = 0; first < all; first += at_once) {
    const std::size_t count = std::min(at_once, all - first);
    for (std::size_t i = 0; i < count; ++i) {
      resize(workspace.loads[i], owned_nodes(), Dim, block.lanes);
      resize(workspace.solutions[i], owned_nodes(), Dim, block.lanes);
      elements_.set_load(densities, regions_[number], CaseStrain<Dim>(*strains_, cases_.cases[first + i]),
                         workspace.loads[i]);
    }
    const auto reports =
        solver_->solve(std::span(workspace.loads).first(count), std::span(workspace.solutions).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      pick(workspace.solutions[i], result_.nodes[number], result_.of_case(first + i).increments[number]);
      workspace.count.add(reports[i], block.first, "forward");
    }
  }
  if (deposition_) result_.weights[number] = deposition_->weights(densities, block, result_.nodes[number]);
  for (std::size_t i = 0; i < all; ++i) result_.add_counted(number, result_.of_case(i));
}

template <int Dim>
std::vector<double> ProcessSimulation<Dim>::increment(int layer, bool counted) const {
  for (int group = 0; group < groups_.count(); ++group)
    for (std::size_t number = 0; number < deal_.blocks[group].size(); ++number) {
      const int lane = layer - deal_.blocks[group][number].first;
      if (lane < 0 || lane >= deal_.blocks[group][number].lanes) continue;
      std::vector<double> result(result_.displacement.size());
      for (std::size_t i = 0; group == groups_.index() && i < result_.nodes[number].size() * Dim; ++i)
        result[result_.in_field(number, i, Dim)] =
            counted ? result_.counted(number, i, lane) : result_.increments[number](i, lane);
      groups_.broadcast(group, result);
      return result;
    }
  return {};
}

template <int Dim>
void ProcessSimulation<Dim>::pull_back(const LayerDensities& densities,
                                       std::span<const ProcessAdjoint> functionals,
                                       std::span<const ProcessDerivatives> derivatives) {
  std::vector<Functional> all;
  for (std::size_t i = 0; i < functionals.size(); ++i) {
    const std::vector<double>& of_release = functionals[i].release;
    all.push_back({i, &functionals[i], &derivatives[i], {}});
    if (!of_release.empty())
      all.back().motion = in_first_group([&] { return release_->adjoint(of_release); });
  }
  for (const ProcessDerivatives& own : derivatives)
    if (own.strains != nullptr) own.strains->resize(strains_->input_count(), 0.0);
  adjoint_loads_.update(densities, result_, functionals);
  SolveCount count(densities.count());
  groups_.run([&] {
    Workspace workspace(count);
    for (std::size_t number = 0; number < result_.blocks.size(); ++number)
      pull_back_block(densities, number, all, workspace);
  });
  if (solver_->saves_memory()) solver_->release_memory();
  count.gather(groups_);
  expect(count.all, /*adjoint=*/true);
  adjoint_iterations_ = std::move(count.largest);
}

/// The block's operators are set up once for all functionals, which come as many at a time as the solver can
/// use. Functionals with negligible loads have explicit derivatives only.
template <int Dim>
void ProcessSimulation<Dim>::pull_back_block(const LayerDensities& densities, std::size_t number,
                                             std::span<const Functional> functionals, Workspace& workspace) {
  const LayerBlock& block = result_.blocks[number];
  workspace.missing.clear();
  for (int lane = 0; deposition_ && lane < block.lanes; ++lane)
    workspace.missing.push_back(deposition_->missing(densities.stage[block.first + lane]));
  std::vector<const Functional*> solved;
  for (std::size_t i = 0; i < functionals.size(); ++i) {
    if (adjoint_loads_.any(i, block))
      solved.push_back(&functionals[i]);
    else
      add_derivatives(densities, number, functionals[i], nullptr, workspace);
  }
  if (solved.empty()) return;
  set_operators(densities, regions_[number], false);
  const std::size_t at_once = std::min(solved.size(), solver_->sets_at_once());
  workspace.loads.resize(at_once);
  workspace.solutions.resize(at_once);
  for (std::size_t first = 0; first < solved.size(); first += at_once)
    solve_adjoints(densities, number,
                   std::span(solved).subspan(first, std::min(at_once, solved.size() - first)), workspace);
}

template <int Dim>
void ProcessSimulation<Dim>::solve_adjoints(const LayerDensities& densities, std::size_t number,
                                            std::span<const Functional* const> functionals,
                                            Workspace& workspace) {
  const LayerBlock& block = result_.blocks[number];
  const std::span<LaneVector> loads = std::span(workspace.loads).first(functionals.size());
  const std::span<LaneVector> adjoints = std::span(workspace.solutions).first(functionals.size());
  for (std::size_t i = 0; i < functionals.size(); ++i) {
    const Functional& functional = *functionals[i];
    resize(loads[i], owned_nodes(), Dim, block.lanes);
    resize(adjoints[i], owned_nodes(), Dim, block.lanes);
    adjoint_loads_.set(*functional.from, functional.number, result_, number, loads[i]);
    if (!functional.motion.empty())
      supports_.subtract_motion(densities, regions_[number], functional.motion, loads[i]);
  }
  const auto reports = solver_->solve(loads, adjoints);
  for (std::size_t i = 0; i < functionals.size(); ++i) {
    workspace.count.add(reports[i], block.first, "adjoint");
    if (!functionals[i]->motion.empty()) supports_.add_motion(functionals[i]->motion, adjoints[i]);
    add_derivatives(densities, number, *functionals[i], &adjoints[i], workspace);
  }
}

/// By the adjoints of a block, if it has any, and through the weights.
template <int Dim>
void ProcessSimulation<Dim>::add_derivatives(const LayerDensities& densities, std::size_t number,
                                             const Functional& functional, const LaneVector* adjoint,
                                             Workspace& workspace) const {
  const ProcessDerivatives& to = *functional.to;
  const std::vector<double>& combination = functional.from->combination;
  LaneVector combined;
  if (!combination.empty()) combined = result_.combined_increments(combination, number);
  const LaneVector& increments = combination.empty() ? result_.increments[number] : combined;
  if (adjoint != nullptr) {
    // Functionals of the same block share its increments.
    if (workspace.spread_from != &increments)
      spread(increments, result_.nodes[number], owned_nodes(), workspace.increments);
    workspace.spread_from = combination.empty() ? &increments : nullptr;
    elements_.add_derivatives(densities, regions_[number],
                              CaseStrain<Dim>(*strains_, cases_.factors(combination)), workspace.increments,
                              *adjoint, *to.densities,
                              to.strains != nullptr ? std::span(*to.strains) : std::span<double>());
  }
  if (deposition_)
    deposition_->add_derivatives(workspace.missing, result_.blocks[number].first, result_.nodes[number],
                                 weight_derivatives(*functional.from, result_, number, increments),
                                 *to.densities);
  if (to.sink != nullptr) to.sink->flush();
}

FABSEQ_INSTANTIATE_CLASS(ProcessSimulation);

}  // namespace fabseq
