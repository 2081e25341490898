// SPDX-License-Identifier: MIT
#include "solve/lane_heat.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/log_event.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "solve/lane_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace fabseq {

/// Steps of conjugate gradients from the second level on cost next to nothing and take care of sheets a few
/// elements thick. On the first level they do not pay: where designs get rough, diffusivities differ by
/// orders of magnitude between neighbours, and even an exact coarse solution would not help. So there is no
/// patience.
template <int Dim>
LaneCycle LaneHeat<Dim>::cycle() {
  return {
      .kind = SolverCycle::k, .degree = 2, .steps = {1, 4, 2}, .patient_steps = {1, 4, 2}, .patient_end = 2};
}

template <int Dim>
LaneCycle LaneHeat<Dim>::cycle_of_steps() {
  return {
      .kind = SolverCycle::k, .degree = 2, .steps = {1, 1, 1}, .patient_steps = {1, 4, 2}, .patient_end = 2};
}

template <int Dim>
LaneHeat<Dim>::LaneHeat(const Grid<Dim>& grid, const SystemDomain& domain, bool lumped, int max_iterations,
                        const AssembledSolverSettings& reference, int lanes, const LaneCycle& cycle)
    : grid_(grid),
      domain_(domain),
      lumped_(lumped),
      problem_(grid.domain().thickness, lumped),
      reference_settings_(reference),
      stop_{.tolerance = reference.tolerance, .max_iterations = max_iterations},
      hierarchy_(grid, domain),
      layout_(grid, hierarchy_.level(0), 1),
      solver_(hierarchy_, problem_, cycle.narrowing(lanes == widest_block)),
      most_lanes_(lanes),
      numbers_(hierarchy_.element_numbers(domain)) {}

template <int Dim>
void LaneHeat<Dim>::set_operator(const HeatOperator& of) {
  const auto are_finite = [](std::span<const double> values) {
    return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
  };
  diffusivity_.assign(of.diffusivity.begin(), of.diffusivity.end());
  reaction_.assign(of.reaction.begin(), of.reaction.end());
  diagonal_.assign(of.diagonal.begin(), of.diagonal.end());
  const bool finite = are_finite(of.diffusivity) && are_finite(of.reaction) && are_finite(of.diagonal);
  std::array<int, 2> on_ranks = {finite ? 0 : 1, diagonal_.empty() ? 0 : 1};
  sum_in_place(grid_.comm(), std::span<int>(on_ranks));
  finite_ = on_ranks[0] == 0;
  has_diagonal_ = on_ranks[1] > 0;
  if (has_diagonal_ && finite_) smeared_reaction_ = reaction_with_diagonal();
  is_set_up_.fill(false);
  fallback_is_set_up_ = false;
}

/// Coarse grids know elements only. An element's reaction grows by the mean, over its nodes, of the
/// diagonal's ratio to the node's reaction: where there is next to none, next to none is added.
template <int Dim>
std::vector<double> LaneHeat<Dim>::reaction_with_diagonal() const {
  const auto& offsets = grid_.corner_offsets();
  std::vector<double> of_corners(static_cast<std::size_t>(grid_.ghosted_nodes().count()), 0.0);
  std::vector<double> ratio(diagonal_.size());
  const double mass = grid_.element_volume() / corner_count<Dim>;
  for (std::size_t e = 0; e < reaction_.size(); ++e)
    for (const int corner : offsets) of_corners[domain_.first_corners[e] + corner] += mass * reaction_[e];
  grid_.exchange(1).add_to_owned(of_corners, ratio);
  for (std::size_t node = 0; node < ratio.size(); ++node)
    ratio[node] = ratio[node] > 0.0 ? diagonal_[node] / ratio[node] : 0.0;
  const std::vector<double> ghosted = grid_.exchange(1).ghosted(ratio);
  std::vector<double> result = reaction_;
  for (std::size_t e = 0; e < result.size(); ++e) {
    double mean = 0.0;
    for (const int corner : offsets) mean += ghosted[domain_.first_corners[e] + corner] / corner_count<Dim>;
    result[e] *= 1.0 + mean;
  }
  return result;
}

template <int Dim>
template <int Width>
void LaneHeat<Dim>::set_up(LaneCg<LaneHeatProblem<Dim>, Width>& solver) {
  LaneArray& coefficients = solver.matrix().coefficients();
  for (std::size_t e = 0; e < numbers_.size(); ++e) {
    coefficients[numbers_[e] * 2] = diffusivity_[e];
    coefficients[numbers_[e] * 2 + 1] = reaction_[e];
  }
  LaneArray diagonal;
  if (!has_diagonal_) {
    solver.set_up();
  } else {
    LaneVector owned(static_cast<int>(diagonal_.size()), 1, 1);
    owned.values = diagonal_;
    layout_.to_mesh(owned, 1, diagonal);
    LaneArray smeared = coefficients;
    for (std::size_t e = 0; e < numbers_.size(); ++e) smeared[numbers_[e] * 2 + 1] = smeared_reaction_[e];
    solver.set_up_with(smeared);
  }
  solver.set_diagonal(std::move(diagonal));
}

template <int Dim>
std::vector<SolveReport> LaneHeat<Dim>::solve_from(FirstGuess guess, std::span<const LaneVector> loads,
                                                   std::span<LaneVector> solutions) {
  static const LogEvent event("fabseq heat lanes");
  const auto scope = event.enter();
  std::vector<SolveReport> reports;
  for (std::size_t block = 0; block < loads.size(); ++block) {
    const std::vector<SolveReport> of_block = solve_block(guess, loads[block], solutions[block]);
    reports.insert(reports.end(), of_block.begin(), of_block.end());
  }
  solve_again(loads, solutions, reports);
  return reports;
}

template <int Dim>
std::vector<SolveReport> LaneHeat<Dim>::solve_block(FirstGuess guess, const LaneVector& load,
                                                    LaneVector& solution) {
  if (!finite_) return std::vector<SolveReport>(load.lanes, report_of({.finite = false}));
  std::vector<SolveReport> reports;
  with_narrowest(solver_, load.lanes, [&]<int Width>(auto& solver) {
    if (!is_set_up_[Width]) {
      set_up<Width>(solver);
      is_set_up_[Width] = true;
    }
    layout_.to_mesh(load, Width, load_);
    if (guess == FirstGuess::given) layout_.to_mesh(solution, Width, solution_);
    const auto outcomes = guess == FirstGuess::given ? solver.improve(load_, solution_, load.lanes, stop_)
                                                     : solver.solve(load_, solution_, load.lanes, stop_);
    for (const LaneOutcome& outcome : outcomes) reports.push_back(report_of(outcome));
    layout_.to_owned(solution_, Width, solution);
  });
  return reports;
}

template <int Dim>
void LaneHeat<Dim>::solve_again(std::span<const LaneVector> loads, std::span<LaneVector> solutions,
                                std::vector<SolveReport>& reports) {
  struct Leftover {
    std::size_t block, report;
    int lane;
  };
  std::vector<Leftover> leftovers;
  std::vector<LaneVector> again;
  std::size_t next = 0;
  for (std::size_t block = 0; block < loads.size(); ++block)
    for (int lane = 0; lane < loads[block].lanes; ++lane, ++next) {
      if (reports[next].converged || std::isnan(reports[next].residual)) continue;
      leftovers.push_back({block, next, lane});
      again.emplace_back(loads[block].nodes, 1, 1).set_lane(0, loads[block].lane(lane));
    }
  if (leftovers.empty()) return;
  const SolveReport& first = reports[leftovers[0].report];
  warn(grid_.comm(),
       formatted("heat: %zu of %zu solves did not converge, the first in %d iterations of the lane solver to "
                 "a relative preconditioned residual of %g; solving again by the reference path",
                 leftovers.size(), reports.size(), first.iterations, first.residual));
  std::vector<LaneVector> solved = again;
  const std::vector<SolveReport> new_reports = fallback().solve(again, solved);
  for (std::size_t i = 0; i < leftovers.size(); ++i) {
    solutions[leftovers[i].block].set_lane(leftovers[i].lane, solved[i].values);
    reports[leftovers[i].report] = new_reports[i];
  }
}

template <int Dim>
void LaneHeat<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  reference_settings_.tolerance = tolerance.value;
  stop_.tolerance = tolerance.value;
  stop_.reach = tolerance.reach;
  if (fallback_) fallback_->set_tolerance(tolerance);
}

/// The lanes keep nothing of their solves; what lasts is the fallback.
template <int Dim>
void LaneHeat<Dim>::start_cold() {
  is_set_up_.fill(false);
  fallback_.reset();
  fallback_is_set_up_ = false;
}

template <int Dim>
void LaneHeat<Dim>::release_memory() {
  solver_.release_memory();
  is_set_up_.fill(false);
  layout_.release_memory();
  for (LaneArray* array : {&load_, &solution_}) free_memory(*array);
}

template <int Dim>
ReferenceHeat<Dim>& LaneHeat<Dim>::fallback() {
  if (!fallback_)
    fallback_ = std::make_unique<ReferenceHeat<Dim>>(grid_, domain_, lumped_, reference_settings_);
  if (!fallback_is_set_up_) fallback_->set_operator(current());
  fallback_is_set_up_ = true;
  return *fallback_;
}

FABSEQ_INSTANTIATE_CLASS(LaneHeat);

}  // namespace fabseq
