// SPDX-License-Identifier: MIT
#include "sequence/heat_sequence.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/base/verdict.h"
#include "fabseq/sequence/element_means.h"
#include "fabseq/sequence/geodesic_distance.h"
#include "sequence/start_domain.h"
#include "sequence/time_adjoints.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

namespace {

/// Whether to lump the mass matrix. With the consistent one the temperature leaves its range where the drain
/// outweighs conduction.
bool lump_mass(const HeatSettings& settings, double reaction, double edge) {
  if (settings.mass != MassRule::automatic) return settings.mass == MassRule::lumped;
  return reaction * edge * edge / 6.0 > std::min(settings.min_diffusivity, settings.void_diffusivity);
}

/// K_0 T of each part element, [part element][corner], where K_0 is the conductivity matrix for unit
/// diffusivity. `temperature`: T on the ghosted node box. Local.
template <int Dim>
std::vector<double> heat_flux(const Part<Dim>& part, const ElementMatrices<Dim>& element,
                              std::span<const double> temperature) {
  constexpr int count = corner_count<Dim>;
  const auto& offsets = part.grid().corner_offsets();
  const auto& corners = part.first_corners();
  std::vector<double> flux(corners.size() * count);
  for (std::size_t e = 0; e < corners.size(); ++e)
    for (int i = 0; i < count; ++i) {
      double sum = 0.0;
      for (int j = 0; j < count; ++j)
        sum += element.conductivity()[i * count + j] * temperature[corners[e] + offsets[j]];
      flux[e * count + i] = sum;
    }
  return flux;
}

/// dJ/dkappa_e = lambda^T K_0 T, one part field per lane. `adjoints`: lambda on the owned nodes. Collective.
template <int Dim>
std::vector<std::vector<double>> by_diffusivity(const Part<Dim>& part, std::span<const double> heat_flux,
                                                const LaneVector& adjoints) {
  const Grid<Dim>& grid = part.grid();
  const auto& corners = part.first_corners();
  const int lanes = adjoints.lanes;
  const std::vector<double> ghosted = grid.exchange(lanes).ghosted(adjoints.values);
  std::vector<std::vector<double>> result(lanes, std::vector<double>(corners.size()));
  std::vector<double> sums(lanes);
  for (std::size_t e = 0; e < corners.size(); ++e) {
    std::fill(sums.begin(), sums.end(), 0.0);
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      const double flux = heat_flux[e * corner_count<Dim> + corner];
      const double* adjoint =
          &ghosted[static_cast<std::size_t>(corners[e] + grid.corner_offsets()[corner]) * lanes];
      for (int lane = 0; lane < lanes; ++lane) sums[lane] += flux * adjoint[lane];
    }
    for (int lane = 0; lane < lanes; ++lane) result[lane][e] = sums[lane];
  }
  return result;
}

/// Distance of temperatures from [0, 1] above which the discrete maximum principle does not hold.
constexpr double temperature_tolerance = 1e-9;

}  // namespace

template <int Dim>
HeatModel<Dim>::HeatModel(const Part<Dim>& part, const HeatSettings& settings)
    : element(part.grid().spacing(), part.grid().domain().thickness, 0.0),
      reaction(settings.drain / std::pow(settings.characteristic_length.value_or(part.longest_edge()), 2)),
      lumped(lump_mass(settings, reaction, part.grid().largest_spacing())),
      domain(start_domain(part)) {}

template <int Dim>
HeatSequence<Dim>::HeatSequence(const Part<Dim>& part, const HeatSettings& settings, double target_gradient,
                                std::unique_ptr<const HeatModel<Dim>> model,
                                std::unique_ptr<HeatSolver<Dim>> solver, MPI_Comm across, int lanes)
    : part_(part),
      settings_(settings),
      target_gradient_(target_gradient),
      model_(std::move(model)),
      solver_(std::move(solver)),
      forward_(*solver_, across),
      lanes_(lanes),
      filter_(part, settings.filter_radius) {}

template <int Dim>
std::vector<double> HeatSequence<Dim>::initial_design() const {
  const std::size_t count = variables();
  if (settings_.initial) return std::vector<double>(count, *settings_.initial);
  // Along a path of constant |grad T| = g the heat equation gives kappa = alpha / (2 g^2) (T^2 - T_end^2)
  // (docs/formulation.md 2.1).
  const std::vector<double> distance = geodesic_distance(part_);
  double farthest = 0.0;
  for (const double s : distance) farthest = std::max(farthest, s);
  farthest = max(part_.grid().comm(), farthest);
  const double gradient = target_gradient_ > 0.0 ? target_gradient_ : 0.95 / farthest;
  const double end = std::max(0.0, 1.0 - gradient * farthest);
  std::vector<double> design(count);
  for (std::size_t e = 0; e < count; ++e) {
    const double temperature = std::max(0.0, 1.0 - gradient * distance[e]);
    const double diffusivity =
        model_->reaction / (2.0 * gradient * gradient) * (temperature * temperature - end * end);
    design[e] = std::clamp(diffusivity, settings_.min_diffusivity, settings_.max_diffusivity);
  }
  return design;
}

template <int Dim>
const PseudoTime<Dim>& HeatSequence<Dim>::update(std::span<const double> design) {
  diffusivity_ = part_.expand(filter_.apply(design), settings_.void_diffusivity);
  solve_temperature();
  derive_time();
  return time_;
}

/// T is 1 at the fixed nodes plus a correction that vanishes there: K_ff T_f = -K_fd 1.
template <int Dim>
void HeatSequence<Dim>::solve_temperature() {
  time_.temperature = forward_.solve(
      prescribed_load(), [&] { solver_->set_operator(diffusivity_, model_->reaction); }, "the heat solve");
  time_.iterations = forward_.iterations();
  for (std::size_t n = 0; n < time_.temperature.size(); ++n)
    if (model_->domain.fixed[n] != 0) time_.temperature[n] = 1.0;
  ghosted_temperature_ = part_.grid().exchange(1).ghosted(time_.temperature);
}

/// Load -K 1_d, where 1_d is 1 at the fixed nodes. Only elements with a fixed node contribute.
template <int Dim>
LaneVector HeatSequence<Dim>::prescribed_load() const {
  constexpr int corners = corner_count<Dim>;
  const Grid<Dim>& grid = part_.grid();
  const auto& offsets = grid.corner_offsets();
  const ElementMatrices<Dim>& element = model_->element;
  const auto& mass = element.mass(model_->lumped);
  const std::vector<double> fixed(model_->domain.fixed.begin(), model_->domain.fixed.end());
  const std::vector<double> ghosted_fixed = grid.exchange(1).ghosted(fixed);
  std::vector<double> ghosted_load(ghosted_fixed.size(), 0.0);
  for (std::size_t e = 0; e < diffusivity_.size(); ++e) {
    const int first = model_->domain.first_corners[e];
    for (int j = 0; j < corners; ++j) {
      if (ghosted_fixed[first + offsets[j]] == 0.0) continue;
      for (int i = 0; i < corners; ++i)
        ghosted_load[first + offsets[i]] -= diffusivity_[e] * element.conductivity()[i * corners + j] +
                                            model_->reaction * mass[i * corners + j];
    }
  }
  LaneVector load(static_cast<int>(fixed.size()), 1, 1);
  grid.exchange(1).add_to_owned(ghosted_load, load.values);
  return load;
}

template <int Dim>
void HeatSequence<Dim>::derive_time() {
  const Grid<Dim>& grid = part_.grid();
  ElementMeans means = element_means<Dim>(part_, model_->element, ghosted_temperature_);
  time_.time = std::move(means.mean);
  time_.gradient = std::move(means.gradient);
  for (double& t : time_.time) t = 1.0 - t;
  for (double& component : time_.gradient) component = -component;
  double lowest = 1.0, highest = 1.0;
  for (const double value : time_.temperature) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  const auto leaves_range = [this] {
    return time_.lowest_temperature < -temperature_tolerance ||
           time_.highest_temperature > 1.0 + temperature_tolerance;
  };
  const bool left_before = leaves_range();
  time_.lowest_temperature = min(grid.comm(), lowest);
  time_.highest_temperature = max(grid.comm(), highest);
  if (leaves_range() && !left_before)
    warn(formatted("the virtual temperature leaves [0, 1]: %g to %g", time_.lowest_temperature,
                   time_.highest_temperature));
}

template <int Dim>
std::vector<std::vector<double>> HeatSequence<Dim>::pull_back(std::span<const TimeDerivatives> rows) {
  const std::vector<double> flux = heat_flux(part_, model_->element, ghosted_temperature_);
  std::vector<std::vector<double>> result;
  const auto add = [&](const LaneVector& adjoints) {
    for (const std::vector<double>& gradient : by_diffusivity(part_, flux, adjoints))
      result.push_back(filter_.apply_transpose(gradient));
  };
  // The adjoint solves K_T lambda = -dJ/dT. As t = 1 - T, the load -dJ/dT is dJ/dt.
  adjoint_iterations_ =
      solve_time_adjoints<Dim>(part_, model_->element, *solver_, rows, lanes_, add, "a heat adjoint");
  if (solver_->saves_memory()) solver_->release_memory();
  return result;
}

FABSEQ_INSTANTIATE_CLASS(HeatSequence);
FABSEQ_INSTANTIATE_STRUCT(HeatModel);

}  // namespace fabseq
