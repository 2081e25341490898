#include "fabseq/sequence/heat_sequence.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/sequence/geodesic_distance.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace fabseq {

namespace {

void require_convergence(const SolveReport& report, const char* what) {
  if (report.converged) return;
  std::ostringstream text;
  text << what << " did not converge: " << report.iterations << " iterations, residual " << report.residual
       << " (" << report.reason << ')';
  throw NumericalError(text.str());
}

/// Beyond this the discrete maximum principle does not hold.
constexpr double temperature_tolerance = 1e-9;

}  // namespace

template <int Dim>
HeatSequence<Dim>::HeatSequence(const Part<Dim>& part, const SequenceSettings& settings,
                                double target_gradient, const AssembledSolverSettings& solver)
    : part_(part),
      settings_(settings),
      target_gradient_(target_gradient),
      reaction_(settings.drain / std::pow(settings.characteristic_length.value_or(part.longest_edge()), 2)),
      element_(part.grid().spacing(), part.grid().domain().thickness, 0.3),
      filter_(part, settings.filter_radius),
      domain_(make_domain()) {
  const auto numbering = std::make_shared<UnknownNumbering<Dim>>(part.grid(), domain_);
  system_ = std::make_unique<AssembledSystem<Dim>>(domain_, numbering, solver);
}

template <int Dim>
SystemDomain HeatSequence<Dim>::make_domain() const {
  const Grid<Dim>& grid = part_.grid();
  SystemDomain domain;
  grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t) {
    domain.first_corners.push_back(grid.first_corner(element));
  });
  domain.fixed.resize(static_cast<std::size_t>(grid.owned_nodes().count()));
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    domain.fixed[offset] = part_.on_plate(node) && part_.touched_nodes()[offset] != 0 ? 1 : 0;
  });
  return domain;
}

template <int Dim>
bool HeatSequence<Dim>::lump_mass() const {
  if (settings_.mass != MassRule::automatic) return settings_.mass == MassRule::lumped;
  const double edge = part_.grid().largest_spacing();
  return reaction_ * edge * edge / 6.0 > std::min(settings_.min_diffusivity, settings_.void_diffusivity);
}

template <int Dim>
DesignSpace HeatSequence<Dim>::space() const {
  return {settings_.min_diffusivity, settings_.max_diffusivity, settings_.scale == VariableScale::log};
}

template <int Dim>
std::vector<double> HeatSequence<Dim>::initial_design() const {
  const std::size_t count = variables();
  if (settings_.initial) return std::vector<double>(count, *settings_.initial);
  // Along a path of constant |grad T| = g the equation gives kappa = alpha / (2 g^2) (T^2 - T_end^2),
  // formulation 2.1.
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
        reaction_ / (2.0 * gradient * gradient) * (temperature * temperature - end * end);
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

/// T = 1 on the fixed nodes plus a correction that vanishes there: K_ff T_f = -K_fd 1.
template <int Dim>
void HeatSequence<Dim>::solve_temperature() {
  const Grid<Dim>& grid = part_.grid();
  const auto& mass = lump_mass() ? element_.lumped_mass() : element_.consistent_mass();
  const std::vector<double> reaction(domain_.first_corners.size(), reaction_);
  system_->assemble({{element_.conductivity(), diffusivity_}, {mass, reaction}});

  const std::size_t owned = domain_.fixed.size();
  std::vector<double> temperature(owned), load(owned);
  for (std::size_t n = 0; n < owned; ++n) temperature[n] = domain_.fixed[n];
  ghosted_temperature_.assign(static_cast<std::size_t>(grid.ghosted_nodes().count()), 0.0);
  grid.exchange(1).to_ghosted(temperature, ghosted_temperature_);
  std::vector<double> ghosted_load(ghosted_temperature_.size(), 0.0);
  const auto& offsets = grid.corner_offsets();
  for (std::size_t e = 0; e < domain_.first_corners.size(); ++e)
    for (int i = 0; i < corner_count<Dim>; ++i)
      for (int j = 0; j < corner_count<Dim>; ++j) {
        const int entry = i * corner_count<Dim> + j;
        ghosted_load[domain_.first_corners[e] + offsets[i]] -=
            (diffusivity_[e] * element_.conductivity()[entry] + reaction_ * mass[entry]) *
            ghosted_temperature_[domain_.first_corners[e] + offsets[j]];
      }
  grid.exchange(1).add_to_owned(ghosted_load, load);
  const SolveReport report = system_->solve(load, temperature);
  require_convergence(report, "the heat solve");
  time_.iterations = report.iterations;
  for (std::size_t n = 0; n < owned; ++n)
    if (domain_.fixed[n] != 0) temperature[n] = 1.0;
  grid.exchange(1).to_ghosted(temperature, ghosted_temperature_);
  time_.temperature = std::move(temperature);
}

template <int Dim>
void HeatSequence<Dim>::derive_time() {
  const Grid<Dim>& grid = part_.grid();
  const auto& corners = part_.first_corners();
  time_.time.assign(corners.size(), 1.0);
  time_.gradient.assign(corners.size() * Dim, 0.0);
  for (std::size_t e = 0; e < corners.size(); ++e)
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      const double value = ghosted_temperature_[corners[e] + grid.corner_offsets()[corner]];
      time_.time[e] -= value / corner_count<Dim>;
      for (int axis = 0; axis < Dim; ++axis)
        time_.gradient[e * Dim + axis] -= element_.center_gradient()[corner * Dim + axis] * value;
    }
  double lowest = 1.0, highest = 1.0;
  for (const double value : time_.temperature) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  const bool was_inside = !(time_.lowest_temperature < -temperature_tolerance) &&
                          !(time_.highest_temperature > 1.0 + temperature_tolerance);
  time_.lowest_temperature = min(grid.comm(), lowest);
  time_.highest_temperature = max(grid.comm(), highest);
  const bool inside = time_.lowest_temperature >= -temperature_tolerance &&
                      time_.highest_temperature <= 1.0 + temperature_tolerance;
  if (!inside && was_inside) {
    std::ostringstream text;
    text << "the virtual temperature leaves [0, 1]: " << time_.lowest_temperature << " to "
         << time_.highest_temperature;
    warn(text.str());
  }
}

/// Right-hand side of the adjoint, K_T lambda = -dJ/dT, with t = 1 - G T and grad t = -grad T (formulation
/// 8).
template <int Dim>
std::vector<double> HeatSequence<Dim>::adjoint_load(const TimeDerivatives& row) const {
  const Grid<Dim>& grid = part_.grid();
  const auto& corners = part_.first_corners();
  std::vector<double> ghosted(ghosted_temperature_.size(), 0.0);
  std::vector<double> load(domain_.fixed.size());
  for (std::size_t e = 0; e < corners.size(); ++e)
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      double value = row.time[e] / corner_count<Dim>;
      for (int axis = 0; !row.gradient.empty() && axis < Dim; ++axis)
        value += row.gradient[e * Dim + axis] * element_.center_gradient()[corner * Dim + axis];
      ghosted[corners[e] + grid.corner_offsets()[corner]] += value;
    }
  grid.exchange(1).add_to_owned(ghosted, load);
  return load;
}

template <int Dim>
std::vector<std::vector<double>> HeatSequence<Dim>::pull_back(std::span<const TimeDerivatives> rows) {
  const Grid<Dim>& grid = part_.grid();
  const auto& corners = part_.first_corners();
  std::vector<std::vector<double>> loads, gradients;
  for (const TimeDerivatives& row : rows) loads.push_back(adjoint_load(row));
  std::vector<std::vector<double>> adjoints(rows.size(), std::vector<double>(domain_.fixed.size()));
  const std::vector<SolveReport> reports = system_->solve(loads, adjoints);
  std::vector<double> ghosted(ghosted_temperature_.size());
  adjoint_iterations_.clear();
  for (std::size_t row = 0; row < rows.size(); ++row) {
    require_convergence(reports[row], "a heat adjoint");
    adjoint_iterations_.push_back(reports[row].iterations);
    grid.exchange(1).to_ghosted(adjoints[row], ghosted);
    // dJ/dkappa_e = lambda^T K_0 T
    std::vector<double> gradient(corners.size(), 0.0);
    for (std::size_t e = 0; e < corners.size(); ++e)
      for (int i = 0; i < corner_count<Dim>; ++i) {
        double flux = 0.0;
        for (int j = 0; j < corner_count<Dim>; ++j)
          flux += element_.conductivity()[i * corner_count<Dim> + j] *
                  ghosted_temperature_[corners[e] + grid.corner_offsets()[j]];
        gradient[e] += ghosted[corners[e] + grid.corner_offsets()[i]] * flux;
      }
    gradients.push_back(filter_.apply_transpose(gradient));
  }
  return gradients;
}

template class HeatSequence<2>;
template class HeatSequence<3>;

}  // namespace fabseq
