#include "fabseq/process/process_simulation.h"

#include "fabseq/base/error.h"
#include "fabseq/base/log_event.h"

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

}  // namespace

template <int Dim>
ProcessSimulation<Dim>::ProcessSimulation(const ElasticModel<Dim>& model,
                                          std::unique_ptr<ElasticitySolver<Dim>> solver)
    : model_(model), solver_(std::move(solver)) {}

template <int Dim>
void ProcessSimulation<Dim>::set_operators(const LayerDensities& densities, int first, int lanes,
                                           bool changed) {
  // Elements outside the part, where the model has any, carry the least stiffness.
  std::vector<double> stiffness(model_.domain.first_corners.size() * lanes, model_.settings.min_stiffness);
  for (int lane = 0; lane < lanes; ++lane) {
    const auto& stage = densities.stage[first + lane];
    for (std::size_t e = 0; e < stage.size(); ++e)
      stiffness[static_cast<std::size_t>(model_.part_position[e]) * lanes + lane] =
          model_.stiffness(stage[e]);
  }
  solver_->set_operators(first, lanes, stiffness, changed);
}

template <int Dim>
LaneVector ProcessSimulation<Dim>::loads(const LayerDensities& densities, int first, int lanes) const {
  static const LogEvent event("fabseq loads");
  const auto scope = event.enter();
  const Grid<Dim>& grid = model_.part.grid();
  LaneVector owned(static_cast<int>(grid.owned_nodes().count()), Dim, lanes);
  LaneVector ghosted(static_cast<int>(grid.ghosted_nodes().count()), Dim, lanes);
  const auto& corners = model_.part.first_corners();
  for (std::size_t e = 0; e < corners.size(); ++e)
    for (int lane = 0; lane < lanes; ++lane) {
      const double factor = model_.load(densities.layer[first + lane][e]);
      if (factor == 0.0) continue;
      for (int i = 0; i < element_unknowns<Dim>; ++i) {
        const std::size_t node = corners[e] + grid.corner_offsets()[i / Dim];
        ghosted(node * Dim + i % Dim, lane) += factor * model_.strain_load[i];
      }
    }
  grid.exchange(Dim * lanes).add_to_owned(ghosted.values, owned.values);
  return owned;
}

template <int Dim>
const ProcessResult& ProcessSimulation<Dim>::simulate(const LayerDensities& densities) {
  const auto nodes = static_cast<int>(model_.part.grid().owned_nodes().count());
  result_ = ProcessResult();
  result_.displacement.assign(static_cast<std::size_t>(nodes) * Dim, 0.0);
  for (int first = 0; first < densities.count(); first += batch_lanes) {
    const int lanes = std::min(batch_lanes, densities.count() - first);
    set_operators(densities, first, lanes, true);
    const LaneVector load = loads(densities, first, lanes);
    LaneVector increment(nodes, Dim, lanes);
    const auto reports = solver_->solve({&load, 1}, {&increment, 1});
    for (int lane = 0; lane < lanes; ++lane) {
      require_convergence(reports[0][lane], first + lane, "forward");
      result_.iterations.push_back(reports[0][lane].iterations);
    }
    for (std::size_t i = 0; i < increment.unknowns(); ++i)
      for (int lane = 0; lane < lanes; ++lane) result_.displacement[i] += increment(i, lane);
    result_.increments.push_back(std::move(increment));
  }
  return result_;
}

template <int Dim>
std::vector<double> ProcessSimulation<Dim>::increment(int layer) const {
  return result_.increments[layer / batch_lanes].lane(layer % batch_lanes);
}

template <int Dim>
void ProcessSimulation<Dim>::pull_back(const LayerDensities& densities, std::span<const ProcessAdjoint> rows,
                                       std::span<DensityDerivatives* const> derivatives) {
  adjoint_iterations_.assign(densities.count(), 0);
  for (std::size_t batch = 0; batch < result_.increments.size(); ++batch) {
    const LaneVector& increments = result_.increments[batch];
    const int first = static_cast<int>(batch) * batch_lanes;
    const int lanes = increments.lanes;
    std::vector<LaneVector> load, adjoint;
    for (const ProcessAdjoint& row : rows) {
      LaneVector& b = load.emplace_back(increments.nodes, Dim, lanes);
      adjoint.emplace_back(increments.nodes, Dim, lanes);
      for (std::size_t i = 0; i < b.unknowns(); ++i)
        for (int lane = 0; lane < lanes; ++lane)
          b(i, lane) = -(row.displacement.empty() ? 0.0 : row.displacement[i]) -
                       (row.increments.empty() ? 0.0 : row.increments[batch](i, lane));
    }
    set_operators(densities, first, lanes, false);
    const auto reports = solver_->solve(load, adjoint);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      for (int lane = 0; lane < lanes; ++lane) {
        require_convergence(reports[row][lane], first + lane, "adjoint");
        adjoint_iterations_[first + lane] =
            std::max(adjoint_iterations_[first + lane], reports[row][lane].iterations);
      }
      add_derivatives(densities, first, increments, adjoint[row], *derivatives[row]);
    }
  }
}

template <int Dim>
void ProcessSimulation<Dim>::add_derivatives(const LayerDensities& densities, int first,
                                             const LaneVector& increments, const LaneVector& adjoints,
                                             DensityDerivatives& derivatives) const {
  static const LogEvent event("fabseq derivatives");
  const auto scope = event.enter();
  constexpr int unknowns = element_unknowns<Dim>;
  const Grid<Dim>& grid = model_.part.grid();
  const int lanes = increments.lanes;
  const auto ghosted_nodes = static_cast<int>(grid.ghosted_nodes().count());
  LaneVector u(ghosted_nodes, Dim, lanes), lambda(ghosted_nodes, Dim, lanes);
  grid.exchange(Dim * lanes).to_ghosted(increments.values, u.values);
  grid.exchange(Dim * lanes).to_ghosted(adjoints.values, lambda.values);
  const auto& corners = model_.part.first_corners();
  const auto& stiffness = model_.element.stiffness();
  std::array<std::size_t, unknowns> positions{};
  for (int lane = 0; lane < lanes; ++lane) {
    const int layer = first + lane;
    auto& d_stage = DensityDerivatives::touch(derivatives.stage[layer], corners.size());
    auto& d_layer = DensityDerivatives::touch(derivatives.layer[layer], corners.size());
    for (std::size_t e = 0; e < corners.size(); ++e) {
      const double stage_slope = model_.stiffness_derivative(densities.stage[layer][e]);
      const double load_slope = model_.load_derivative(densities.layer[layer][e]);
      std::array<double, unknowns> ue{}, le{};
      for (int i = 0; i < unknowns; ++i) {
        positions[i] = static_cast<std::size_t>(corners[e] + grid.corner_offsets()[i / Dim]) * Dim + i % Dim;
        ue[i] = u(positions[i], lane);
        le[i] = lambda(positions[i], lane);
      }
      double energy = 0.0, work = 0.0;
      for (int i = 0; i < unknowns; ++i) {
        double force = 0.0;
        for (int j = 0; j < unknowns; ++j) force += stiffness[i * unknowns + j] * ue[j];
        energy += le[i] * force;
        work += le[i] * model_.strain_load[i];
      }
      d_stage[e] += stage_slope * energy;
      d_layer[e] -= load_slope * work;
    }
  }
}

template class ProcessSimulation<2>;
template class ProcessSimulation<3>;

}  // namespace fabseq
