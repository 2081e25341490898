// SPDX-License-Identifier: MIT
#include "fabseq/process/release.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/solve/solvers.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// The node of all ranks with the largest measure, the lowest lexicographic number among equals.
template <int Dim, class Measure>
Index<Dim> farthest_node(const Grid<Dim>& grid, const std::vector<int>& nodes, Measure&& measure) {
  double largest = -1.0;
  for (const int node : nodes)
    largest = std::max(largest, measure(grid.node_position(grid.owned_nodes().index(node))));
  largest = max(grid.comm(), largest);
  std::int64_t number = grid.all_nodes().count();
  for (const int node : nodes) {
    const Index<Dim> index = grid.owned_nodes().index(node);
    if (measure(grid.node_position(index)) >= largest * (1.0 - 1e-12))
      number = std::min(number, grid.all_nodes().offset(index));
  }
  return grid.all_nodes().index(min(grid.comm(), number));
}

template <std::size_t Size>
std::array<double, Size> difference(const std::array<double, Size>& a, const std::array<double, Size>& b) {
  std::array<double, Size> result{};
  for (std::size_t axis = 0; axis < Size; ++axis) result[axis] = a[axis] - b[axis];
  return result;
}

template <std::size_t Size>
double length(const std::array<double, Size>& v) {
  return std::sqrt(dot(v, v));
}

/// Supports that hold every rigid motion and nothing else: three nodes in 3D, two in 2D.
template <int Dim>
std::vector<char> statically_determinate_supports(const Grid<Dim>& grid, const std::vector<int>& nodes) {
  std::vector<char> fixed(static_cast<std::size_t>(grid.owned_nodes().count()) * Dim, 0);
  const auto fix = [&](const Index<Dim>& node, int component) {
    if (grid.owned_nodes().contains(node)) fixed[grid.owned_nodes().offset(node) * Dim + component] = 1;
  };
  const auto largest_component = [](const Point<Dim>& v) {
    int best = 0;
    for (int axis = 1; axis < Dim; ++axis)
      if (std::abs(v[axis]) > std::abs(v[best]) * (1.0 + 1e-9)) best = axis;
    return best;
  };
  const Index<Dim> a = farthest_node(grid, nodes, [](const Point<Dim>&) { return 1.0; });
  const Point<Dim> origin = grid.node_position(a);
  const Index<Dim> b =
      farthest_node(grid, nodes, [&](const Point<Dim>& x) { return length(difference(x, origin)); });
  const Point<Dim> edge = difference(grid.node_position(b), origin);
  for (int axis = 0; axis < Dim; ++axis) fix(a, axis);
  for (int axis = 0; axis < Dim; ++axis)
    if (axis != largest_component(edge)) fix(b, axis);
  if constexpr (Dim == 3) {
    const auto cross = [&](const Point<3>& x) {
      const Point<3> e = difference(x, origin);
      return Point<3>{edge[1] * e[2] - edge[2] * e[1], edge[2] * e[0] - edge[0] * e[2],
                      edge[0] * e[1] - edge[1] * e[0]};
    };
    const Index<3> c = farthest_node(grid, nodes, [&](const Point<3>& x) { return length(cross(x)); });
    fix(c, largest_component(cross(grid.node_position(c))));
  }
  return fixed;
}

}  // namespace

template <int Dim>
std::string release_obstacle(const Grid<Dim>& grid, const Supports<Dim>& supports, VoidModel void_model) {
  if (supports.pieces > 1 && void_model == VoidModel::absent)
    return "the part falls into " + std::to_string(supports.pieces) +
           " pieces that only their supports hold together";
  if (!RigidMotions<Dim>(grid, supports.holding).determined())
    return "the supports leave a rigid motion of the part free";
  return "";
}

ReleaseSolver release_solver(const SolverSettings& settings, double tolerance) {
  return {assembled_settings(settings, elasticity_tolerance({tolerance}), release_prefix), settings.path,
          lane_cycle(settings)};
}

template <int Dim>
Release<Dim>::Release(const ElasticModel<Dim>& model, const ReleaseSolver& solver)
    : model_(model),
      settings_(solver),
      rigid_motions_(model.part.grid(), model.supports.holding),
      domain_(model.domain) {
  const std::string reason = release_obstacle(model.part.grid(), model.supports, model.settings.void_model);
  if (!reason.empty()) throw InputError("release: " + reason);
  domain_.fixed = statically_determinate_supports(model.part.grid(), model.supports.holding);
  numbering_ = std::make_shared<UnknownNumbering<Dim>>(model.part.grid(), domain_);
}

template <int Dim>
void Release<Dim>::set_tolerance(double tolerance) {
  settings_.reference.tolerance = tolerance;
  if (system_) system_->set_tolerance(tolerance);
}

template <int Dim>
void Release<Dim>::start_cold() {
  lanes_.reset();
  system_.reset();
}

template <int Dim>
SolveReport Release<Dim>::solve_by_lanes(const std::vector<double>& load, std::vector<double>& solution) {
  const Grid<Dim>& grid = model_.part.grid();
  if (!lanes_)
    lanes_ = std::make_unique<LaneFreeBody<Dim>>(grid, model_.domain, model_.material.poisson,
                                                 settings_.cycle, model_.finished_stiffness());
  SolveReport report = lanes_->solve(load, solution, settings_.reference.tolerance);
  if (report.converged) return report;
  warn(grid.comm(), formatted("release: %d iterations of the lane engine left a relative preconditioned "
                              "residual of %g; solving it again by the reference path",
                              report.iterations, report.residual));
  return solve_by_reference(load, solution);
}

template <int Dim>
SolveReport Release<Dim>::solve_by_reference(const std::vector<double>& load, std::vector<double>& solution) {
  if (!system_) {
    const std::vector<double> stiffness = model_.finished_stiffness();
    system_ = std::make_unique<AssembledSystem<Dim>>(domain_, numbering_, settings_.reference);
    system_->assemble({{model_.element.stiffness(), stiffness}});
  }
  return system_->solve(load, solution);
}

template <int Dim>
std::vector<double> Release<Dim>::solve(const std::vector<double>& load, const char* what) {
  std::vector<double> solution(load.size());
  const SolveReport report = settings_.path == SolverPath::lanes ? solve_by_lanes(load, solution)
                                                                 : solve_by_reference(load, solution);
  require_convergence(report, std::string("the ") + what);
  rigid_motions_.remove_fit(solution);
  return solution;
}

template <int Dim>
std::vector<double> Release<Dim>::displacement(std::span<const double> reactions) {
  std::vector<double> load(reactions.size());
  std::transform(reactions.begin(), reactions.end(), load.begin(), [](double force) { return -force; });
  const std::vector<double> solution = solve(load, "release solve");
  // Nodes outside the model moved with the rigid motion only: they are not there.
  std::vector<double> result(solution.size(), 0.0);
  for (const int node : model_.nodes)
    std::copy_n(&solution[static_cast<std::size_t>(node) * Dim], Dim,
                &result[static_cast<std::size_t>(node) * Dim]);
  return result;
}

template <int Dim>
std::vector<double> Release<Dim>::adjoint(std::span<const double> derivative) {
  std::vector<double> load(derivative.size());
  std::transform(derivative.begin(), derivative.end(), load.begin(), [](double value) { return -value; });
  rigid_motions_.balance(load);
  return solve(load, "adjoint of the release");
}

FABSEQ_INSTANTIATE_FUNCTION(release_obstacle);
FABSEQ_INSTANTIATE_CLASS(Release);

}  // namespace fabseq
