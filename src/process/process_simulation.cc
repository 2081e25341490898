// SPDX-License-Identifier: MIT
#include "fabseq/process/process_simulation.h"

#include "fabseq/base/error.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

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

/// Gives `vector` this size. Its values are left to whoever sets them: the memory of a batch serves the next
/// one, too, for fresh memory costs more than what is done with it here.
void resize(LaneVector& vector, int nodes, int components, int lanes) {
  if (vector.nodes != nodes || vector.components != components || vector.lanes != lanes)
    vector = LaneVector(nodes, components, lanes);
}

/// Load of the adjoint systems of a block: minus dJ/du and minus the block's dJ/d(du_j).
void set_adjoint_load(const ProcessAdjoint& row, std::size_t block, LaneVector& load) {
  for (std::size_t i = 0; i < load.unknowns(); ++i) {
    const double common = row.displacement.empty() ? 0.0 : -row.displacement[i];
    std::fill_n(&load.values[i * load.lanes], load.lanes, common);
  }
  if (row.increments.empty()) return;
  const std::vector<double>& own = row.increments[block].values;
  for (std::size_t i = 0; i < own.size(); ++i) load.values[i] -= own[i];
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
}

template <int Dim>
void ProcessSimulation<Dim>::release_with(const ReleaseSolver& solver) {
  release_ = std::make_unique<Release<Dim>>(model_, solver);
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
  groups_.run([&] {
    LaneVector load;
    for (std::size_t number = 0; number < result_.blocks.size(); ++number)
      solve_block(densities, number, load);
  });
  solver_->rest();
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
  for (std::size_t i = 0; i < increment.unknowns(); ++i)
    for (int lane = 0; lane < block.lanes; ++lane) result_.displacement[i] += increment(i, lane);
}

template <int Dim>
std::vector<double> ProcessSimulation<Dim>::increment(int layer) const {
  for (int group = 0; group < groups_.count(); ++group)
    for (std::size_t number = 0; number < deal_.blocks[group].size(); ++number) {
      const int lane = layer - deal_.blocks[group][number].first;
      if (lane < 0 || lane >= deal_.blocks[group][number].lanes) continue;
      std::vector<double> result(result_.displacement.size());
      if (group == groups_.index()) result = result_.increments[number].lane(lane);
      groups_.broadcast(group, result);
      return result;
    }
  return {};
}

template <int Dim>
void ProcessSimulation<Dim>::pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> rows,
                                       std::span<const ProcessDerivatives> derivatives) {
  adjoint_iterations_.assign(densities.count(), 0);
  std::vector<std::vector<double>> motions;
  for (const ProcessAdjoint& row : rows)
    motions.push_back(row.release.empty() ? std::vector<double>() : release_motion(row.release));
  for (const ProcessDerivatives& row : derivatives)
    if (row.strains != nullptr) {
      row.strains->of_elements.resize(elements_.strains().of_elements.size(), 0.0);
      row.strains->of_layers.resize(elements_.strains().of_layers.size(), 0.0);
    }
  groups_.run([&] {
    std::vector<LaneVector> loads, adjoints;
    for (std::size_t number = 0; number < result_.blocks.size(); ++number)
      pull_back_block(densities, number, rows, derivatives, motions, loads, adjoints);
  });
  solver_->rest();
  groups_.sum(adjoint_iterations_);
  for (int layer = 0; layer < densities.count(); ++layer)
    expected_work_[layer] = 1.0 + result_.iterations[layer] + adjoint_iterations_[layer];
}

/// The block's operators are set up once for all rows, which come as many at a time as the solver can use.
template <int Dim>
void ProcessSimulation<Dim>::pull_back_block(const LayerDensities& densities, std::size_t number,
                                             std::span<const ProcessAdjoint> rows,
                                             std::span<const ProcessDerivatives> derivatives,
                                             std::span<const std::vector<double>> motions,
                                             std::vector<LaneVector>& loads,
                                             std::vector<LaneVector>& adjoints) {
  set_operators(densities, result_.blocks[number], false);
  const std::size_t at_once = std::min(rows.size(), solver_->sets_at_once());
  loads.resize(at_once);
  adjoints.resize(at_once);
  for (std::size_t first = 0; first < rows.size(); first += at_once) {
    const std::size_t count = std::min(at_once, rows.size() - first);
    pull_back_rows(densities, number, rows.subspan(first, count), derivatives.subspan(first, count),
                   motions.subspan(first, count), std::span(loads).first(count),
                   std::span(adjoints).first(count));
  }
}

template <int Dim>
void ProcessSimulation<Dim>::pull_back_rows(const LayerDensities& densities, std::size_t number,
                                            std::span<const ProcessAdjoint> rows,
                                            std::span<const ProcessDerivatives> derivatives,
                                            std::span<const std::vector<double>> motions,
                                            std::span<LaneVector> loads, std::span<LaneVector> adjoints) {
  const LayerBlock& block = result_.blocks[number];
  const LaneVector& increments = result_.increments[number];
  for (std::size_t row = 0; row < rows.size(); ++row) {
    resize(loads[row], increments.nodes, Dim, block.lanes);
    resize(adjoints[row], increments.nodes, Dim, block.lanes);
    set_adjoint_load(rows[row], number, loads[row]);
    if (!motions[row].empty()) supports_.subtract_motion(densities, block.first, motions[row], loads[row]);
  }
  const auto reports = solver_->solve(loads, adjoints);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (int lane = 0; lane < block.lanes; ++lane) {
      require_convergence(reports[row][lane], block.first + lane, "adjoint");
      int& iterations = adjoint_iterations_[block.first + lane];
      iterations = std::max(iterations, reports[row][lane].iterations);
    }
    if (!motions[row].empty()) supports_.add_motion(motions[row], adjoints[row]);
    StrainField not_asked_for;
    elements_.add_derivatives(
        densities, block.first, increments, adjoints[row], *derivatives[row].densities,
        derivatives[row].strains != nullptr ? *derivatives[row].strains : not_asked_for);
    if (derivatives[row].after_block) derivatives[row].after_block();
  }
}

template class ProcessSimulation<2>;
template class ProcessSimulation<3>;

}  // namespace fabseq
