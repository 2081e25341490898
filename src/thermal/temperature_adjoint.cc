// SPDX-License-Identifier: MIT
#include "thermal/temperature_adjoint.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/corner_means.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <utility>

namespace fabseq {

namespace {

/// Whether a functional depends on the temperature with which a layer leaves the next one to begin.
bool uses_interpass(const TemperatureAdjoint& functional, int number) {
  const std::size_t next = static_cast<std::size_t>(number) + 1;
  return next < functional.interpass.size() && functional.interpass[next] != 0.0;
}

}  // namespace

template <int Dim>
BackwardSteps<Dim>::BackwardSteps(const ThermalModel<Dim>& model, HeatSolver<Dim>& solver,
                                  const SolveTolerance& tolerance, const LayerTemperatures& temperatures,
                                  const LayerDensities& densities,
                                  std::span<const TemperatureAdjoint> functionals, int lanes)
    : model_(model), steps_(model, solver, tolerance), temperatures_(temperatures), densities_(densities) {
  const auto nodes = static_cast<std::size_t>(model.owned_nodes());
  for (std::size_t first = 0; first < functionals.size(); first += lanes) {
    const std::size_t count = std::min<std::size_t>(lanes, functionals.size() - first);
    Block& block = blocks_.emplace_back();
    block.functionals = functionals.subspan(first, count);
    for (LaneVector* vector : {&block.theta, &block.lambda})
      *vector = LaneVector(model.owned_nodes(), 1, static_cast<int>(count));
    for (auto* values : {&block.capacity, &block.capacity_before, &block.film, &block.heat})
      values->assign(nodes * count, 0.0);
    block.share.assign(model.part_position.size() * count, 0.0);
    block.seconds.assign(count, 0.0);
  }
}

template <int Dim>
int BackwardSteps<Dim>::last_layer() const {
  for (int number = temperatures_.count() - 1; number >= 0; --number)
    for (const Block& block : blocks_)
      for (const TemperatureAdjoint& functional : block.functionals)
        if (!functional.ends.empty() || uses_interpass(functional, number)) return number;
  return -1;
}

template <int Dim>
void BackwardSteps<Dim>::run() {
  const int last = last_layer();
  if (last < 0) return;
  ThermalLayer layer = model_.layer(densities_, last, temperatures_.region(last));
  for (int number = last; number >= 0; --number) {
    std::optional<ThermalLayer> before;
    if (number > 0) before = model_.layer(densities_, number - 1, temperatures_.region(number - 1));
    for (Block& block : blocks_) add_interpass(block, number);
    add_end(number, 1);
    back_through(number, layer, before ? before->capacity : model_.first_capacity());
    for (Block& block : blocks_)
      if (block.active) add_densities(block, number, layer);
    if (before) layer = std::move(*before);
  }
}

/// B = T_a + sum w_e theta_e / W, with theta_e the mean of an element's nodes: dB/dtheta_n = sum over its
/// elements of w_e / (W c_n), dB/dw_e = (theta_e - B + T_a) / W.
template <int Dim>
void BackwardSteps<Dim>::add_interpass(Block& block, int number) {
  const auto is_used = [&](const TemperatureAdjoint& functional) {
    return uses_interpass(functional, number);
  };
  if (std::ranges::none_of(block.functionals, is_used)) return;
  block.active = true;
  const Grid<Dim>& grid = model_.part.grid();
  const std::vector<double> theta =
      spread_out(temperatures_.at_end(number), model_.nodes, model_.domain.fixed.size());
  const std::vector<double> weight = ThermalModel<Dim>::weights(densities_.layer[number]),
                            mean = corner_means(grid, model_.part.first_corners(), theta);
  const double total = sum(grid.comm(), std::accumulate(weight.begin(), weight.end(), 0.0)),
               excess = temperatures_.interpass[number + 1] - model_.properties.ambient;
  const std::vector<double> of_nodes = model_.lumped(model_.part.first_corners(), weight, 1.0 / total);
  for (int lane = 0; lane < block.lanes(); ++lane) {
    const TemperatureAdjoint& functional = block.functionals[lane];
    if (!is_used(functional)) continue;
    const double factor = functional.interpass[number + 1];
    for (std::size_t node = 0; node < of_nodes.size(); ++node)
      block.theta(node, lane) += factor * of_nodes[node];
    std::vector<double>& d_layer =
        DensityDerivatives::zeros_if_empty(functional.densities->layer[number], weight.size());
    for (std::size_t e = 0; e < weight.size(); ++e) d_layer[e] += factor * (mean[e] - excess) / total;
  }
}

template <int Dim>
void BackwardSteps<Dim>::add_end(int number, int end) {
  const auto nodes = static_cast<std::size_t>(model_.owned_nodes());
  const std::size_t first = (2 * static_cast<std::size_t>(number) + end) * nodes;
  for (Block& block : blocks_)
    for (int lane = 0; lane < block.lanes(); ++lane) {
      const std::span<const double> ends = block.functionals[lane].ends;
      if (ends.empty()) continue;
      block.active = true;
      for (std::size_t node = 0; node < nodes; ++node) block.theta(node, lane) += ends[first + node];
    }
}

template <int Dim>
void BackwardSteps<Dim>::back_through(int number, const ThermalLayer& layer,
                                      std::span<const double> capacity_before) {
  const std::vector<ThermalStep> schedule = model_.steps(layer.mass);
  const std::size_t all_nodes = model_.domain.fixed.size();
  for (std::size_t i = schedule.size(); i-- > 0;) {
    const ThermalStep& step = schedule[i];
    if (i + 1 == static_cast<std::size_t>(model_.properties.welding_steps)) add_end(number, 0);
    if (i + 1 == schedule.size() || step.seconds != schedule[i + 1].seconds) steps_.set(layer, step.seconds);
    const std::vector<double> before = spread_out(temperatures_.before(number, i), model_.nodes, all_nodes),
                              after =
                                  spread_out(temperatures_.after_steps[number][i], model_.nodes, all_nodes);
    solve(after, step_name(number, i) + ", backwards");
    const std::span<const double> capacity = i == 0 ? capacity_before : std::span(layer.capacity);
    for (Block& block : blocks_) {
      if (!block.active) continue;
      add_step(block, layer, step, before, after, i == 0);
      for (const int node : model_.nodes) {
        const double stored = capacity[node] * model_.properties.storage.value(before[node]);
        for (int lane = 0; lane < block.lanes(); ++lane)
          block.theta(node, lane) = stored * block.lambda(node, lane);
      }
    }
  }
}

/// All active blocks.
template <int Dim>
void BackwardSteps<Dim>::solve(std::span<const double> theta, const std::string& what) {
  std::vector<LaneVector> loads, lambdas;
  for (Block& block : blocks_) {
    if (!block.active) continue;
    loads.push_back(std::move(block.theta));
    lambdas.push_back(std::move(block.lambda));
  }
  steps_.solve_adjoint(theta, loads, lambdas, what);
  std::size_t next = 0;
  for (Block& block : blocks_) {
    if (!block.active) continue;
    block.theta = std::move(loads[next]);
    block.lambda = std::move(lambdas[next++]);
  }
}

template <int Dim>
void BackwardSteps<Dim>::add_step(Block& block, const ThermalLayer& layer, const ThermalStep& step,
                                  std::span<const double> theta_before, std::span<const double> theta_after,
                                  bool is_first) {
  const int lanes = block.lanes();
  std::vector<double>& of_before = is_first ? block.capacity_before : block.capacity;
  const ThermalProperties& properties = model_.properties;
  std::vector<double> potential(theta_after.size(), 0.0);
  for (const int node : model_.nodes) {
    const double stored_before = properties.storage.integral(theta_before[node]),
                 stored_after = properties.storage.integral(theta_after[node]);
    potential[node] = properties.conduction.integral(theta_after[node]);
    for (int lane = 0; lane < lanes; ++lane) {
      const std::size_t at = static_cast<std::size_t>(node) * lanes + lane;
      const double lambda = block.lambda.values[at], product = lambda * theta_after[node];
      block.capacity[at] -= lambda * stored_after;
      of_before[at] += lambda * stored_before;
      block.film[at] -= step.seconds * product;
      if (!step.welding) continue;
      block.heat[at] += lambda;
      block.seconds[lane] -= layer.film[node] * product;
    }
  }
  add_conduction(block, layer, step, potential);
}

/// lambda_e . (int grad N . grad N) phi'_e of every element: the flow is the same in all lanes.
template <int Dim>
void BackwardSteps<Dim>::add_conduction(Block& block, const ThermalLayer& layer, const ThermalStep& step,
                                        std::span<const double> potential) {
  constexpr int corners = corner_count<Dim>;
  const Grid<Dim>& grid = model_.part.grid();
  const int lanes = block.lanes();
  const std::vector<double> phi = ghosted(potential, 1), lambda = ghosted(block.lambda.values, lanes);
  const auto& matrix = model_.element.conductivity();
  std::size_t next = 0;  // part element
  for (std::size_t e = 0; e < layer.share.size(); ++e) {
    const bool in_part =
        next < model_.part_position.size() && model_.part_position[next] == static_cast<int>(e);
    const std::size_t number = next;
    next += in_part ? 1 : 0;
    if (layer.share[e] == 0.0) continue;
    const std::size_t first = model_.domain.first_corners[e];
    std::array<double, corners> value{}, flow{};
    for (int j = 0; j < corners; ++j) value[j] = phi[first + grid.corner_offsets()[j]];
    for (int i = 0; i < corners; ++i)
      for (int j = 0; j < corners; ++j) flow[i] += matrix[i * corners + j] * value[j];
    for (int lane = 0; lane < lanes; ++lane) {
      double product = 0.0;
      for (int i = 0; i < corners; ++i)
        product += flow[i] * lambda[(first + grid.corner_offsets()[i]) * lanes + lane];
      product *= model_.properties.conductivity;
      if (in_part) block.share[number * lanes + lane] -= step.seconds * product;
      if (step.welding) block.seconds[lane] -= layer.share[e] * product;
    }
  }
}

template <int Dim>
std::vector<double> BackwardSteps<Dim>::ghosted(std::span<const double> owned, int lanes) const {
  return model_.part.grid().exchange(lanes).ghosted(owned);
}

template <int Dim>
void BackwardSteps<Dim>::add_densities(Block& block, int number, const ThermalLayer& layer) {
  const Grid<Dim>& grid = model_.part.grid();
  const ThermalProperties& properties = model_.properties;
  const auto lanes = static_cast<std::size_t>(block.lanes());
  const std::size_t elements = model_.part_position.size();
  const double of_corner = grid.element_volume() / corner_count<Dim>;
  const std::vector<double> capacity = ghosted(block.capacity, block.lanes()),
                            heat = ghosted(block.heat, block.lanes());
  std::vector<double> of_film(layer.share.size() * lanes, 0.0);
  if (properties.film > 0.0)
    model_.film.add_derivative(layer.standing, properties.film, ghosted(block.film, block.lanes()),
                               block.lanes(), of_film);
  sum_in_place(grid.comm(), std::span<double>(block.seconds));
  const auto counts = [&](std::size_t e) { return layer.share[model_.part_position[e]] != 0.0; };
  std::vector<double> of_stage(elements), of_heat(elements);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    for (std::size_t e = 0; e < elements; ++e) {
      double of_capacity = 0.0;
      of_stage[e] = of_heat[e] = 0.0;
      if (!counts(e)) continue;
      for (const int corner : grid.corner_offsets()) {
        const std::size_t at =
            (static_cast<std::size_t>(model_.part.first_corners()[e]) + corner) * lanes + lane;
        of_capacity += capacity[at];
        of_heat[e] += properties.heat * of_corner * heat[at] / properties.welding_steps;
      }
      of_stage[e] = (1.0 - ThermalModel<Dim>::least_share) *
                        (properties.capacity * of_corner * of_capacity + block.share[e * lanes + lane]) +
                    of_film[static_cast<std::size_t>(model_.part_position[e]) * lanes + lane];
    }
    // Steps grow with the mass that is deposited.
    const double of_mass =
        layer.mass > 0.0 ? block.seconds[lane] / (properties.rate * properties.welding_steps) : 0.0;
    add_to_functional(block, static_cast<int>(lane), number, of_stage, of_heat, of_mass);
  }
  block.capacity = std::exchange(block.capacity_before, std::vector<double>(block.capacity.size(), 0.0));
  for (auto* sums : {&block.film, &block.heat, &block.share, &block.seconds})
    std::fill(sums->begin(), sums->end(), 0.0);
}

template <int Dim>
void BackwardSteps<Dim>::add_to_functional(const Block& block, int lane, int number,
                                           std::span<const double> of_stage, std::span<const double> of_heat,
                                           double of_mass) const {
  const TemperatureAdjoint& functional = block.functionals[lane];
  auto& d_stage = DensityDerivatives::zeros_if_empty(functional.densities->stage[number], of_stage.size());
  auto& d_layer = DensityDerivatives::zeros_if_empty(functional.densities->layer[number], of_heat.size());
  const double of_density = of_mass * model_.properties.mass_density * model_.part.grid().element_volume();
  for (std::size_t e = 0; e < of_stage.size(); ++e) {
    d_stage[e] += of_stage[e];
    d_layer[e] += of_heat[e] + of_density;
  }
  if (functional.sink != nullptr) functional.sink->flush();
}

FABSEQ_INSTANTIATE_CLASS(BackwardSteps);

}  // namespace fabseq
