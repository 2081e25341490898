// SPDX-License-Identifier: MIT
#include "thermal/temperature_steps.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace fabseq {

namespace {

/// A round of Newton's method is solved this closely: rounds that follow solve for what is left.
constexpr double tolerance_of_rounds = 1e-2;
/// A round that leaves more than this makes the next one linear at the temperatures that it has reached.
constexpr double slow = 0.1;
constexpr int most_rounds = 40, most_cuts = 8;
/// Changes of the potentials that are smaller, relative to the largest, may be rounding: over a long step
/// what is conducted is a difference of much more than what is stored.
constexpr double of_rounding = 1e-10;
/// How much of the imbalance along a change may be left, turned round.
constexpr double most_beyond = 0.5;

}  // namespace

std::string step_name(int layer, std::size_t step) {
  return formatted("temperature: layer %d, step %zu", layer + 1, step + 1);
}

template <int Dim>
void TemperatureSteps<Dim>::set(const ThermalLayer& layer, double seconds) {
  layer_ = &layer;
  seconds_ = seconds;
  is_set_ = false;
  diffusivity_ = layer.share;
  for (double& value : diffusivity_) value *= seconds * model_.properties.conductivity;
}

/// Sets the diagonal to C s + dt H / phi' with s = psi'/phi'. Coarse grids know what elements store: each
/// stores by the least s of its nodes, and nodes have what is more.
template <int Dim>
void TemperatureSteps<Dim>::linearize(std::span<const double> theta) {
  const ThermalProperties& properties = model_.properties;
  if (is_set_) return;
  is_set_ = properties.constant();
  std::vector<double> ratio(theta.size(), 1.0);
  diagonal_.assign(theta.size(), 0.0);
  for (const int node : model_.nodes) {
    const double of_conduction = properties.conduction.value(theta[node]);
    ratio[node] = properties.storage.value(theta[node]) / of_conduction;
    diagonal_[node] = layer_->capacity[node] * ratio[node] + seconds_ * layer_->film[node] / of_conduction;
  }
  const std::vector<double> reaction = reaction_of_elements(ratio);
  std::vector<double> more;
  // Without a film there is nothing to add.
  if (!properties.constant() || properties.film > 0.0) {
    more = model_.lumped(model_.domain.first_corners, reaction, model_.part.grid().element_volume());
    for (std::size_t node = 0; node < more.size(); ++node)
      more[node] = std::max(diagonal_[node] - more[node], 0.0);
  }
  solver_.set_operator(HeatOperator{diffusivity_, reaction, more});
}

template <int Dim>
std::vector<double> TemperatureSteps<Dim>::reaction_of_elements(std::span<const double> ratio) const {
  const Grid<Dim>& grid = model_.part.grid();
  std::vector<double> result = layer_->share;
  for (double& value : result) value *= model_.properties.capacity;
  if (model_.properties.constant()) return result;
  const std::vector<double> ghosted = grid.exchange(1).ghosted(ratio);
  for (std::size_t e = 0; e < result.size(); ++e) {
    double least = ghosted[model_.domain.first_corners[e]];
    for (const int corner : grid.corner_offsets())
      least = std::min(least, ghosted[model_.domain.first_corners[e] + corner]);
    result[e] *= least;
  }
  return result;
}

template <int Dim>
std::vector<double> TemperatureSteps<Dim>::imbalance(std::span<const double> load,
                                                     std::span<const double> theta,
                                                     std::span<const double> potential) const {
  const ThermalProperties& properties = model_.properties;
  const std::vector<double> conducted = model_.conducted(layer_->share, potential);
  std::vector<double> result(load.size(), 0.0);
  for (const int node : model_.nodes) {
    if (model_.domain.fixed[node] != 0 || layer_->capacity[node] == 0.0) continue;
    result[node] = load[node] - layer_->capacity[node] * properties.storage.integral(theta[node]) -
                   seconds_ * (conducted[node] + layer_->film[node] * theta[node]);
  }
  return result;
}

template <int Dim>
double TemperatureSteps<Dim>::product(std::span<const double> a, std::span<const double> b) const {
  double result = 0.0;
  for (const int node : model_.nodes) result += a[node] * b[node];
  return sum(model_.part.grid().comm(), result);
}

template <int Dim>
double TemperatureSteps<Dim>::size_of(std::span<const double> imbalance,
                                      std::span<const double> diagonal) const {
  double result = 0.0;
  for (const int node : model_.nodes)
    if (diagonal[node] > 0.0) result += imbalance[node] * imbalance[node] / diagonal[node];
  return std::sqrt(sum(model_.part.grid().comm(), result));
}

template <int Dim>
bool TemperatureSteps<Dim>::is_rounding(std::span<const double> change,
                                        std::span<const double> potential) const {
  std::array<double, 2> largest{};
  for (const int node : model_.nodes) {
    largest[0] = std::max(largest[0], std::abs(change[node]));
    largest[1] = std::max(largest[1], std::abs(potential[node]));
  }
  max_in_place(model_.part.grid().comm(), std::span<double>(largest));
  return largest[0] <= of_rounding * largest[1];
}

template <int Dim>
void TemperatureSteps<Dim>::set_theta(std::span<const double> potential, std::span<double> theta) const {
  for (const int node : model_.nodes) theta[node] = model_.properties.conduction.excess_of(potential[node]);
  model_.hold(theta);
}

/// A step minimizes a convex function of the potentials. Where a change goes so far that the imbalance along
/// it turns round, it ends where the imbalances on both sides say that it does.
template <int Dim>
void TemperatureSteps<Dim>::move(std::span<const double> load, std::span<const double> change,
                                 std::vector<double>& rest, std::vector<double>& theta,
                                 std::vector<double>& potential) const {
  const std::vector<double> from = potential;
  const double before = product(rest, change);
  double share = 1.0;
  for (int cut = 0; cut <= most_cuts; ++cut) {
    for (const int node : model_.nodes) potential[node] = from[node] + share * change[node];
    set_theta(potential, theta);
    rest = imbalance(load, theta, potential);
    const double beyond = -product(rest, change);
    if (beyond <= most_beyond * before || before <= 0.0) return;
    share *= before / (before + beyond);
  }
}

/// Solves by Newton's method; a linear step takes one round.
template <int Dim>
int TemperatureSteps<Dim>::advance(std::span<const double> capacity_before, double share,
                                   std::vector<double>& theta, const std::string& what) {
  const ThermalProperties& properties = model_.properties;
  std::vector<double> load(theta.size(), 0.0), potential(theta.size(), 0.0);
  for (const int node : model_.nodes) {
    load[node] =
        capacity_before[node] * properties.storage.integral(theta[node]) + share * layer_->heat[node];
    if (layer_->capacity[node] == 0.0) theta[node] = 0.0;  // outside the region
  }
  model_.hold(theta);
  for (const int node : model_.nodes) potential[node] = properties.conduction.integral(theta[node]);
  if (!properties.constant()) {
    SolveTolerance of_rounds = tolerance_;
    of_rounds.value = std::max(tolerance_.value, tolerance_of_rounds);
    solver_.set_tolerance(of_rounds);
  }
  LaneVector rest(model_.owned_nodes(), 1, 1), change(model_.owned_nodes(), 1, 1);
  rest.values = imbalance(load, theta, potential);
  linearize(theta);
  if (properties.constant()) {
    const int iterations = solve(rest, change, what);
    for (const int node : model_.nodes) potential[node] += change.values[node];
    set_theta(potential, theta);
    return iterations;
  }
  const std::vector<double> weights = diagonal_;
  double left = size_of(rest.values, weights);
  const double enough = tolerance_.value * left;
  int iterations = 0;
  for (int round = 0; round < most_rounds; ++round) {
    iterations += solve(rest, change, what);
    move(load, change.values, rest.values, theta, potential);
    const double before = std::exchange(left, size_of(rest.values, weights));
    if (left <= enough || is_rounding(change.values, potential)) return iterations;
    if (round == 0 || left > slow * before) linearize(theta);
  }
  throw NumericalError(what + formatted(" did not converge in %d rounds of Newton's method", most_rounds));
}

template <int Dim>
int TemperatureSteps<Dim>::solve(const LaneVector& rest, LaneVector& change, const std::string& what) {
  const SolveReport report = solver_.solve({&rest, 1}, {&change, 1}).front();
  require_convergence(report, what);
  return report.iterations;
}

template <int Dim>
void TemperatureSteps<Dim>::solve_adjoint(std::span<const double> theta, std::span<LaneVector> loads,
                                          std::span<LaneVector> lambdas, const std::string& what) {
  linearize(theta);
  if (!model_.properties.constant()) solver_.set_tolerance(tolerance_);
  if (!model_.properties.conduction.is_one())
    for (LaneVector& block : loads)
      for (const int node : model_.nodes)
        for (int lane = 0; lane < block.lanes; ++lane)
          block(node, lane) /= model_.properties.conduction.value(theta[node]);
  for (const SolveReport& report : solver_.solve(loads, lambdas)) require_convergence(report, what);
}

FABSEQ_INSTANTIATE_CLASS(TemperatureSteps);

}  // namespace fabseq
