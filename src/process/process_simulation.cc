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

/// Gives `vector` this size. Its values are left to whoever sets them: the memory of a batch serves the next one,
/// too, for fresh memory costs more than what is done with it here.
void resize(LaneVector& vector, int nodes, int components, int lanes) {
  if (vector.nodes != nodes || vector.components != components || vector.lanes != lanes)
    vector = LaneVector(nodes, components, lanes);
}

/// Load of the adjoint systems of a batch: minus dJ/du and minus the batch's dJ/d(du_j).
void set_adjoint_load(const ProcessAdjoint& row, std::size_t batch, LaneVector& load) {
  for (std::size_t i = 0; i < load.unknowns(); ++i) {
    const double common = row.displacement.empty() ? 0.0 : -row.displacement[i];
    std::fill_n(&load.values[i * load.lanes], load.lanes, common);
  }
  if (row.increments.empty()) return;
  const std::vector<double>& own = row.increments[batch].values;
  for (std::size_t i = 0; i < own.size(); ++i) load.values[i] -= own[i];
}

}  // namespace

template <int Dim>
ProcessSimulation<Dim>::ProcessSimulation(const ElasticModel<Dim>& model,
                                          std::unique_ptr<ElasticitySolver<Dim>> solver)
    : model_(model), elements_(model), solver_(std::move(solver)) {}

template <int Dim>
void ProcessSimulation<Dim>::set_operators(const LayerDensities& densities, int first, int lanes,
                                           bool changed) {
  solver_->set_operators(first, lanes, elements_.stiffness(densities, first, lanes), changed);
}

template <int Dim>
const ProcessResult& ProcessSimulation<Dim>::simulate(const LayerDensities& densities) {
  const auto nodes = static_cast<int>(model_.part.grid().owned_nodes().count());
  result_.displacement.assign(static_cast<std::size_t>(nodes) * Dim, 0.0);
  result_.iterations.clear();
  result_.increments.resize((densities.count() + batch_lanes - 1) / batch_lanes);
  LaneVector load;
  for (int first = 0; first < densities.count(); first += batch_lanes) {
    const int lanes = std::min(batch_lanes, densities.count() - first);
    LaneVector& increment = result_.increments[first / batch_lanes];
    resize(load, nodes, Dim, lanes);
    resize(increment, nodes, Dim, lanes);
    set_operators(densities, first, lanes, true);
    elements_.set_load(densities, first, load);
    const auto reports = solver_->solve({&load, 1}, {&increment, 1});
    for (int lane = 0; lane < lanes; ++lane) {
      require_convergence(reports[0][lane], first + lane, "forward");
      result_.iterations.push_back(reports[0][lane].iterations);
    }
    for (std::size_t i = 0; i < increment.unknowns(); ++i)
      for (int lane = 0; lane < lanes; ++lane) result_.displacement[i] += increment(i, lane);
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
  std::vector<LaneVector> load(rows.size()), adjoint(rows.size());
  for (std::size_t batch = 0; batch < result_.increments.size(); ++batch) {
    const LaneVector& increments = result_.increments[batch];
    const int first = static_cast<int>(batch) * batch_lanes;
    const int lanes = increments.lanes;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      resize(load[row], increments.nodes, Dim, lanes);
      resize(adjoint[row], increments.nodes, Dim, lanes);
      set_adjoint_load(rows[row], batch, load[row]);
    }
    set_operators(densities, first, lanes, false);
    const auto reports = solver_->solve(load, adjoint);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      for (int lane = 0; lane < lanes; ++lane) {
        require_convergence(reports[row][lane], first + lane, "adjoint");
        adjoint_iterations_[first + lane] =
            std::max(adjoint_iterations_[first + lane], reports[row][lane].iterations);
      }
      elements_.add_derivatives(densities, first, increments, adjoint[row], *derivatives[row]);
    }
  }
}

template class ProcessSimulation<2>;
template class ProcessSimulation<3>;

}  // namespace fabseq
