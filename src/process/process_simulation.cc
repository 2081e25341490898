// SPDX-License-Identifier: MIT
#include "fabseq/process/process_simulation.h"

#include "fabseq/base/error.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace fabseq {

namespace {

void require_convergence(const SolveReport& report, int layer, const char* what) {
  if (report.converged && std::isfinite(report.residual)) return;
  std::ostringstream text;
  text << "layer " << layer + 1 << ": the elastic " << what
       << " solve did not converge: " << report.iterations << " iterations, relative preconditioned residual "
       << report.residual << " (" << report.reason << ')';
  throw NumericalError(text.str());
}

/// Gives `vector` this size. Its values are left to whoever sets them: the memory of a block serves the next
/// one, too, for fresh memory costs more than what is done with it here.
void resize(LaneVector& vector, int nodes, int components, int lanes) {
  if (vector.nodes != nodes || vector.components != components || vector.lanes != lanes)
    vector = LaneVector(nodes, components, lanes);
}

/// Load of the adjoint systems of a block: minus dJ/du and minus the block's dJ/d(counted du_j), weighted by
/// what counts of du_j.
void set_adjoint_load(const ProcessAdjoint& functional, const ProcessResult& result, std::size_t block,
                      LaneVector& load) {
  for (std::size_t i = 0; i < load.unknowns(); ++i) {
    const double common = functional.displacement.empty() ? 0.0 : -functional.displacement[i];
    std::fill_n(&load.values[i * load.lanes], load.lanes, common);
  }
  if (!functional.increments.empty()) {
    const std::vector<double>& own = functional.increments[block].values;
    for (std::size_t i = 0; i < own.size(); ++i) load.values[i] -= own[i];
  }
  if (result.weights.empty()) return;
  const LaneVector& weights = result.weights[block];
  for (std::size_t i = 0; i < load.unknowns(); ++i)
    for (int lane = 0; lane < load.lanes; ++lane) load(i, lane) *= weights(i / load.components, lane);
}

}  // namespace

template <int Dim>
ProcessSimulation<Dim>::ProcessSimulation(const ElasticModel<Dim>& model,
                                          std::unique_ptr<ElasticitySolver<Dim>> solver,
                                          const LayerGroups& groups, BlockSolver blocks, int lanes)
    : model_(model),
      groups_(groups),
      block_solver_(blocks),
      lanes_(lanes),
      elements_(model),
      supports_(model),
      solver_(std::move(solver)) {
  result_.all_layers = groups.world();
  if (model.settings.deposition == DepositionModel::nominal)
    deposition_ = std::make_unique<const Deposition<Dim>>(model);
}

template <int Dim>
void ProcessSimulation<Dim>::start_cold() {
  solver_->start_cold();
  if (release_) release_->start_cold();
}

template <int Dim>
void ProcessSimulation<Dim>::deal_out(int layers) {
  if (expected_work_.size() != static_cast<std::size_t>(layers)) expected_work_.assign(layers, 1.0);
  deal_ = deal_out_layers(expected_work_, groups_.count(), lanes_, block_solver_);
  result_.blocks = deal_.blocks[groups_.index()];
}

template <int Dim>
void ProcessSimulation<Dim>::set_operators(const LayerDensities& densities, const LayerBlock& block,
                                           bool changed) {
  solver_->set_operators(block.first, block.lanes, elements_.stiffness(densities, block.first, block.lanes),
                         changed);
}

template <int Dim>
const ProcessResult& ProcessSimulation<Dim>::simulate(const LayerDensities& densities, StrainField strains) {
  elements_.set_strains(std::move(strains));
  const std::int64_t nodes = model_.part.grid().owned_nodes().count();
  deal_out(densities.count());
  result_.displacement.assign(static_cast<std::size_t>(nodes) * Dim, 0.0);
  result_.iterations.assign(densities.count(), 0);
  result_.increments.resize(result_.blocks.size());
  result_.weights.resize(deposition_ ? result_.blocks.size() : 0);
  groups_.run([&] {
    LaneVector load;
    for (std::size_t number = 0; number < result_.blocks.size(); ++number)
      solve_block(densities, number, load);
  });
  solver_->give_back_memory();
  groups_.sum(result_.displacement);
  groups_.sum(result_.iterations);
  // A layer takes some time whatever its iterations.
  for (int layer = 0; layer < densities.count(); ++layer)
    expected_work_[layer] = 1.0 + result_.iterations[layer];
  if (!release_) return result_;
  // A single right-hand side cannot be shared out.
  const std::vector<double> forces = reactions(densities);
  result_.release.assign(forces.size(), 0.0);
  groups_.run([&] {
    if (groups_.index() == 0) result_.release = release_->displacement(forces);
  });
  groups_.broadcast(0, result_.release);
  return result_;
}

template <int Dim>
std::vector<double> ProcessSimulation<Dim>::reactions(const LayerDensities& densities) const {
  std::vector<double> result(model_.domain.fixed.size(), 0.0);
  for (std::size_t number = 0; number < result_.blocks.size(); ++number)
    supports_.add_reactions(densities, elements_.strains(), result_.blocks[number].first,
                            result_.increments[number], result);
  groups_.sum(result);
  return result;
}

/// How the supports move in the adjoints of a functional of the release.
template <int Dim>
std::vector<double> ProcessSimulation<Dim>::release_motion(std::span<const double> derivative) {
  std::vector<double> motion(derivative.size());
  groups_.run([&] {
    if (groups_.index() == 0) motion = release_->adjoint(derivative);
  });
  groups_.broadcast(0, motion);
  return motion;
}

template <int Dim>
void ProcessSimulation<Dim>::solve_block(const LayerDensities& densities, std::size_t number,
                                         LaneVector& load) {
  const LayerBlock& block = result_.blocks[number];
  const auto nodes = static_cast<int>(model_.part.grid().owned_nodes().count());
  LaneVector& increment = result_.increments[number];
  resize(load, nodes, Dim, block.lanes);
  resize(increment, nodes, Dim, block.lanes);
  set_operators(densities, block, true);
  elements_.set_load(densities, block.first, load);
  const auto reports = solver_->solve({&load, 1}, {&increment, 1});
  for (int lane = 0; lane < block.lanes; ++lane) {
    require_convergence(reports[0][lane], block.first + lane, "forward");
    result_.iterations[block.first + lane] = reports[0][lane].iterations;
  }
  if (deposition_) result_.weights[number] = deposition_->weights(densities, block.first, block.lanes);
  for (std::size_t i = 0; i < increment.unknowns(); ++i)
    for (int lane = 0; lane < block.lanes; ++lane)
      result_.displacement[i] += result_.counted(number, i, lane);
}

template <int Dim>
std::vector<double> ProcessSimulation<Dim>::increment(int layer, bool counted) const {
  for (int group = 0; group < groups_.count(); ++group)
    for (std::size_t number = 0; number < deal_.blocks[group].size(); ++number) {
      const int lane = layer - deal_.blocks[group][number].first;
      if (lane < 0 || lane >= deal_.blocks[group][number].lanes) continue;
      std::vector<double> result(result_.displacement.size());
      for (std::size_t i = 0; group == groups_.index() && i < result.size(); ++i)
        result[i] = counted ? result_.counted(number, i, lane) : result_.increments[number](i, lane);
      groups_.broadcast(group, result);
      return result;
    }
  return {};
}

template <int Dim>
void ProcessSimulation<Dim>::pull_back(const LayerDensities& densities,
                                       std::span<const ProcessAdjoint> functionals,
                                       std::span<const ProcessDerivatives> derivatives) {
  adjoint_iterations_.assign(densities.count(), 0);
  std::vector<std::vector<double>> motions;
  for (const ProcessAdjoint& functional : functionals)
    motions.push_back(functional.release.empty() ? std::vector<double>()
                                                 : release_motion(functional.release));
  for (const ProcessDerivatives& own : derivatives)
    if (own.strains != nullptr) {
      own.strains->of_elements.resize(elements_.strains().of_elements.size(), 0.0);
      own.strains->of_layers.resize(elements_.strains().of_layers.size(), 0.0);
    }
  groups_.run([&] {
    std::vector<LaneVector> loads, adjoints;
    for (std::size_t number = 0; number < result_.blocks.size(); ++number)
      pull_back_block(densities, number, {functionals, derivatives, motions}, loads, adjoints);
  });
  solver_->give_back_memory();
  groups_.sum(adjoint_iterations_);
  for (int layer = 0; layer < densities.count(); ++layer)
    expected_work_[layer] = 1.0 + result_.iterations[layer] + adjoint_iterations_[layer];
}

/// The block's operators are set up once for all functionals, which come as many at a time as the solver can
/// use.
template <int Dim>
void ProcessSimulation<Dim>::pull_back_block(const LayerDensities& densities, std::size_t number,
                                             const Functionals& functionals, std::vector<LaneVector>& loads,
                                             std::vector<LaneVector>& adjoints) {
  set_operators(densities, result_.blocks[number], false);
  const std::size_t all = functionals.from.size();
  const std::size_t at_once = std::min(all, solver_->sets_at_once());
  loads.resize(at_once);
  adjoints.resize(at_once);
  for (std::size_t first = 0; first < all; first += at_once) {
    const std::size_t count = std::min(at_once, all - first);
    pull_back_together(densities, number, functionals.part(first, count), std::span(loads).first(count),
                       std::span(adjoints).first(count));
  }
}

template <int Dim>
void ProcessSimulation<Dim>::pull_back_together(const LayerDensities& densities, std::size_t number,
                                                const Functionals& functionals, std::span<LaneVector> loads,
                                                std::span<LaneVector> adjoints) {
  const LayerBlock& block = result_.blocks[number];
  const LaneVector& increments = result_.increments[number];
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const std::vector<double>& motion = functionals.motions[i];
    resize(loads[i], increments.nodes, Dim, block.lanes);
    resize(adjoints[i], increments.nodes, Dim, block.lanes);
    set_adjoint_load(functionals.from[i], result_, number, loads[i]);
    if (!motion.empty()) supports_.subtract_motion(densities, block.first, motion, loads[i]);
  }
  const auto reports = solver_->solve(loads, adjoints);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    for (int lane = 0; lane < block.lanes; ++lane) {
      require_convergence(reports[i][lane], block.first + lane, "adjoint");
      int& iterations = adjoint_iterations_[block.first + lane];
      iterations = std::max(iterations, reports[i][lane].iterations);
    }
    if (!functionals.motions[i].empty()) supports_.add_motion(functionals.motions[i], adjoints[i]);
    const ProcessDerivatives& to = functionals.to[i];
    StrainField not_asked_for;
    elements_.add_derivatives(densities, block.first, increments, adjoints[i], *to.densities,
                              to.strains != nullptr ? *to.strains : not_asked_for);
    if (deposition_) add_deposition_derivatives(densities, number, functionals.from[i], *to.densities);
    if (to.after_block) to.after_block();
  }
}

/// Through the weights: dJ/dw_j = (dJ/du + dJ/d(counted du_j)) . du_j at each node.
template <int Dim>
void ProcessSimulation<Dim>::add_deposition_derivatives(const LayerDensities& densities, std::size_t number,
                                                        const ProcessAdjoint& functional,
                                                        DensityDerivatives& derivatives) const {
  const LaneVector& increments = result_.increments[number];
  LaneVector d_weights(increments.nodes, 1, increments.lanes);
  for (std::size_t i = 0; i < increments.unknowns(); ++i)
    for (int lane = 0; lane < increments.lanes; ++lane) {
      const double common = functional.displacement.empty() ? 0.0 : functional.displacement[i];
      const double own = functional.increments.empty() ? 0.0 : functional.increments[number](i, lane);
      d_weights(i / Dim, lane) += (common + own) * increments(i, lane);
    }
  deposition_->add_derivatives(densities, result_.blocks[number].first, d_weights, derivatives);
}

FABSEQ_INSTANTIATE_CLASS(ProcessSimulation);

}  // namespace fabseq
