// SPDX-License-Identifier: MIT
#include "solve/lane_elasticity.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/log_event.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "solve/lane_report.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace fabseq {

template <int Dim>
LaneElasticity<Dim>::LaneElasticity(const Grid<Dim>& grid, const SystemDomain& domain, double poisson,
                                    const LaneCycle& cycle, int max_iterations,
                                    const AssembledSolverSettings& reference, int lanes)
    : grid_(grid),
      domain_(domain),
      problem_(grid.domain().thickness, poisson),
      reference_settings_(reference),
      max_iterations_(max_iterations),
      stop_{.tolerance = reference.tolerance, .max_iterations = max_iterations},
      hierarchy_(grid, domain),
      layout_(grid, hierarchy_.level(0), Dim),
      solver_(hierarchy_, problem_, cycle.narrowing(lanes == widest_block)),
      most_lanes_(lanes),
      numbers_(hierarchy_.element_numbers(domain)) {}

template <int Dim>
void LaneElasticity<Dim>::set_operators(int first_layer, int lanes, std::span<const double> stiffness,
                                        bool changed) {
  static const LogEvent event("fabseq lane set-up");
  const auto scope = event.enter();
  first_layer_ = first_layer;
  lanes_ = lanes;
  stiffness_.assign(stiffness.begin(), stiffness.end());
  not_finite_.assign(static_cast<std::size_t>(lanes), 0.0);
  for (std::size_t i = 0; i < stiffness.size(); ++i)
    if (!std::isfinite(stiffness[i])) not_finite_[i % lanes] += 1.0;
  sum_in_place(grid_.comm(), not_finite_);
  sets_ = 1;
  with_narrowest(solver_, lanes, [&]<int Width>(auto& solver) {
    width_ = Width;
    LaneArray& coefficients = solver.matrix().coefficients();
    for (std::size_t e = 0; e < numbers_.size(); ++e)
      for (int lane = 0; lane < Width; ++lane)
        coefficients[numbers_[e] * Width + lane] = stiffness[e * lanes + (lane < lanes ? lane : 0)];
    set_up(solver, changed);
  });
}

/// Looks for islands only in systems that have changed.
template <int Dim>
void LaneElasticity<Dim>::set_up(auto& solver, bool changed) {
  const auto layer = [&](int lane) { return first_layer_ + (lane < lanes_ ? lane : 0); };
  typename LaneCg<LaneElasticityProblem<Dim>, widest_block>::Islands islands;
  for (int lane = 0; !changed && lane < width_ && islands_.contains(layer(lane)); ++lane)
    islands.push_back(islands_[layer(lane)]);
  solver.set_up(islands);
  for (int lane = 0; lane < lanes_ && !islands.empty(); ++lane) islands_[layer(lane)] = islands[lane];
}

template <int Dim>
std::size_t LaneElasticity<Dim>::sets_at_once() const {
  std::size_t sets = sets_;
  for (int width = 2 * width_; width <= most_lanes_; width *= 2) sets *= 2;
  return sets;
}

template <int Dim>
std::vector<std::vector<SolveReport>> LaneElasticity<Dim>::solve_from(FirstGuess guess,
                                                                      std::span<const LaneVector> loads,
                                                                      std::span<LaneVector> displacements) {
  static const LogEvent event("fabseq lane solve");
  const auto scope = event.enter();
  std::vector<std::vector<SolveReport>> reports(loads.size());
  const std::size_t at_once = sets_at_once();
  for (std::size_t first = 0; first < loads.size(); first += at_once) {
    const std::size_t count = std::min(at_once, loads.size() - first);
    solve_sets(loads.subspan(first, count), displacements.subspan(first, count),
               std::span(reports).subspan(first, count), guess);
  }
  for (std::size_t set = 0; set < loads.size(); ++set)
    for (int lane = 0; lane < lanes_; ++lane)
      if (SolveReport& report = reports[set][lane]; !report.converged && std::isfinite(report.residual)) {
        report.converged = is_correction_;
        if (!report.converged) solve_again(loads[set], displacements[set], lane, report);
      }
  return reports;
}

/// Several sets fill lanes that the layers leave free.
template <int Dim>
void LaneElasticity<Dim>::solve_sets(std::span<const LaneVector> loads, std::span<LaneVector> displacements,
                                     std::span<std::vector<SolveReport>> reports, FirstGuess guess) {
  const auto count = static_cast<int>(loads.size());
  if (count == 1) {
    reports[0] = solve_lanes(loads[0], displacements[0], guess);
    return;
  }
  widen(loads.size());
  LaneVector load(loads[0].nodes, loads[0].components, count * lanes_), displacement = load;
  const auto put_together = [&](std::span<const LaneVector> sets, LaneVector& all) {
    for (std::size_t i = 0; i < all.unknowns(); ++i)
      for (int set = 0; set < count; ++set)
        std::copy_n(&sets[set].values[i * lanes_], lanes_, &all.values[(i * count + set) * lanes_]);
  };
  put_together(loads, load);
  if (guess == FirstGuess::given) put_together(displacements, displacement);
  const std::vector<SolveReport> all = solve_lanes(load, displacement, guess);
  for (std::size_t i = 0; i < load.unknowns(); ++i)
    for (int set = 0; set < count; ++set)
      std::copy_n(&displacement.values[(i * count + set) * lanes_], lanes_,
                  &displacements[set].values[i * lanes_]);
  for (int set = 0; set < count; ++set)
    reports[set].assign(all.begin() + set * lanes_, all.begin() + (set + 1) * lanes_);
}

/// Sets up a wider solver, with the block's systems as often as there are sets, from the one that is.
template <int Dim>
void LaneElasticity<Dim>::widen(std::size_t sets) {
  while (static_cast<std::size_t>(sets_) < sets) {
    width_ *= 2;
    with_narrowest(solver_, width_,
                   [&]<int Width>(auto& solver) { solver.set_up_from_half(sets_ * lanes_); });
    sets_ *= 2;
  }
}

/// Solves for load_ in the mesh of a solver, `Width` lanes wide.
template <int Dim>
std::vector<LaneOutcome> LaneElasticity<Dim>::iterate(auto& solver, const LaneVector& displacement, int lanes,
                                                      FirstGuess guess) {
  if (guess == FirstGuess::zero) return solver.solve(load_, displacement_, lanes, stop_);
  layout_.to_mesh(displacement, width_, displacement_);
  typename std::remove_reference_t<decltype(solver)>::Scalars smallest;
  smallest.fill(1.0);
  for (int lane = 0; lane < lanes; ++lane)
    if (const auto known = smallest_.find(first_layer_ + lane % lanes_); known != smallest_.end())
      smallest[lane] = known->second;
  return solver.improve(load_, displacement_, lanes, stop_, smallest);
}

/// Solves side by side; lane i is one of layer i % lanes_.
template <int Dim>
std::vector<SolveReport> LaneElasticity<Dim>::solve_lanes(const LaneVector& load, LaneVector& displacement,
                                                          FirstGuess guess) {
  std::vector<SolveReport> reports;
  with_narrowest(solver_, width_, [&]<int Width>(auto& solver) {
    layout_.to_mesh(load, Width, load_);
    if (saves_memory()) layout_.release_memory();
    for (LaneOutcome outcome : iterate(solver, displacement, load.lanes, guess)) {
      smallest_[first_layer_ + static_cast<int>(reports.size()) % lanes_] = outcome.smallest;
      if (not_finite_[reports.size() % lanes_] > 0.0) outcome.finite = false;
      reports.push_back(report_of(outcome));
    }
    layout_.to_owned(displacement_, Width, displacement);
    if (saves_memory()) layout_.release_memory();
  });
  return reports;
}

template <int Dim>
void LaneElasticity<Dim>::solve_again(const LaneVector& load, LaneVector& displacement, int lane,
                                      SolveReport& report) {
  warn(grid_.comm(),
       formatted("layer %d: %d iterations of the lane solver left a relative preconditioned residual of %g; "
                 "solving it again by the reference path",
                 first_layer_ + lane + 1, report.iterations, report.residual));
  if (!fallback_)
    fallback_ = std::make_unique<ReferenceElasticity<Dim>>(
        grid_, domain_, problem_.matrices(grid_.spacing()).stiffness, reference_settings_);
  std::vector<double> stiffness(numbers_.size());
  for (std::size_t e = 0; e < numbers_.size(); ++e) stiffness[e] = stiffness_[e * lanes_ + lane];
  LaneVector one_load(load.nodes, load.components, 1), solution(load.nodes, load.components, 1);
  one_load.set_lane(0, load.lane(lane));
  fallback_->set_operators(first_layer_ + lane, 1, stiffness, true);
  report = fallback_->solve({&one_load, 1}, {&solution, 1})[0][0];
  displacement.set_lane(lane, solution.lane(0));
}

template <int Dim>
void LaneElasticity<Dim>::set_tolerance(const SolveTolerance& tolerance) {
  reference_settings_.tolerance = tolerance.smallest();
  stop_.tolerance = tolerance.value;
  stop_.reach = tolerance.reach;
  stop_.of_islands = tolerance.of_islands;
  stop_.one_cycle = tolerance.correction && tolerance.reach > 1.0;
  is_correction_ = tolerance.correction;
  stop_.max_iterations = tolerance.correction ? std::min(correction_steps, max_iterations_) : max_iterations_;
  if (fallback_) fallback_->set_tolerance(tolerance);
}

template <int Dim>
void LaneElasticity<Dim>::release_memory() {
  solver_.release_memory();
  layout_.release_memory();
  for (LaneArray* array : {&load_, &displacement_}) free_memory(*array);
  free_memory(stiffness_);
}

template <int Dim>
std::string LaneElasticity<Dim>::description() const {
  const auto& finest = hierarchy_.level(0);
  std::int64_t nodes = 0;
  for (const auto& range : finest.counted) nodes += range.end - range.begin;
  return "lanes: flexible CG + multigrid, " + std::to_string(hierarchy_.count()) + " levels, " +
         std::to_string(sum(grid_.comm(), nodes * Dim)) + " unknowns a layer, up to " +
         std::to_string(most_lanes_) + (most_lanes_ == 1 ? " layer at once" : " layers at once") +
         (saves_memory() ? ", to save memory" : "");
}

FABSEQ_INSTANTIATE_CLASS(LaneElasticity);

}  // namespace fabseq
