// SPDX-License-Identifier: MIT
#include "fabseq/solve/lane_free_body.h"

#include "fabseq/base/log_event.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/stop.h"
#include "fabseq/lanes/flush_to_zero.h"
#include "fabseq/lanes/lane_multigrid_impl.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Added to the last level's diagonal, relative to it: far below its elastic modes, far above rounding.
constexpr double shift = 1e-7;
/// As LaneStop's.
constexpr double error_factor = 2.0;

LaneCycle of_free_body(LaneCycle cycle) {
  cycle.shift = shift;
  return cycle;
}

}  // namespace

template <int Dim>
SystemDomain LaneFreeBody<Dim>::without_supports(SystemDomain domain) {
  std::fill(domain.fixed.begin(), domain.fixed.end(), 0);
  return domain;
}

template <int Dim>
LaneFreeBody<Dim>::LaneFreeBody(const Grid<Dim>& grid, const SystemDomain& domain, double poisson,
                                const LaneCycle& cycle, std::span<const double> stiffness)
    : cycle_(of_free_body(cycle)),
      problem_(grid.domain().thickness, poisson),
      hierarchy_(grid, without_supports(domain)),
      layout_(grid, hierarchy_.level(0), Dim),
      matrix_(hierarchy_.level(0), problem_),
      multigrid_(hierarchy_, problem_, cycle_),
      direction_(matrix_.size()),
      image_(matrix_.size()),
      rounded_rest_(matrix_.size()),
      preconditioned_(matrix_.size()) {
  const LaneMesh<Dim>& mesh = hierarchy_.level(0).mesh;
  for (std::size_t e = 0; e < stiffness.size(); ++e)
    matrix_.coefficients()[mesh.element_number(grid.ghosted_nodes().index(domain.first_corners[e]))] =
        stiffness[e];
  multigrid_.finest().coefficients().assign(matrix_.coefficients().begin(), matrix_.coefficients().end());
  positive_ = multigrid_.set_up()[0];
  locate_nodes();
  weigh_nodes();
  of_displacements_ = factor_motions([](std::int64_t) { return 1.0; });
  of_forces_ = factor_motions([this](std::int64_t node) { return stiffness_[node]; });
}

template <int Dim>
void LaneFreeBody<Dim>::locate_nodes() {
  const LaneLevel<Dim>& level = hierarchy_.level(0);
  positions_.resize(static_cast<std::size_t>(level.mesh.nodes()) * Dim);
  for (const auto& run : level.mesh.node_runs())
    for (int i = 0; i < run.length; ++i)
      for (int axis = 0; axis < Dim; ++axis)
        positions_[(run.node + i) * Dim + axis] =
            (run.index[axis] + (axis == 0 ? i : 0)) * level.spacing[axis];
  std::array<double, Dim + 1> center{};  // sums of positions, number
  for (const auto& range : level.counted)
    for (std::int64_t node = range.begin; node < range.end; ++node) {
      for (int axis = 0; axis < Dim; ++axis) center[axis] += positions_[node * Dim + axis];
      center[Dim] += 1.0;
    }
  sum_in_place(level.comm, center);
  double extent = 0.0;
  for (int axis = 0; axis < Dim; ++axis) extent += std::pow(level.elements[axis] * level.spacing[axis], 2);
  for (std::size_t i = 0; i < positions_.size(); ++i)
    positions_[i] = (positions_[i] - center[i % Dim] / center[Dim]) / std::sqrt(extent);
}

template <int Dim>
double LaneFreeBody<Dim>::motion(int number, std::int64_t node, int component) const {
  if (number < Dim) return number == component ? 1.0 : 0.0;
  const int a = Dim == 2 ? 0 : (number - Dim + 1) % Dim;
  const int b = Dim == 2 ? 1 : (number - Dim + 2) % Dim;
  if (component == a) return -positions_[node * Dim + b];
  return component == b ? positions_[node * Dim + a] : 0.0;
}

/// Sum of the stiffness of the elements around each node.
template <int Dim>
void LaneFreeBody<Dim>::weigh_nodes() {
  LaneLevel<Dim>& level = hierarchy_.level(0);
  stiffness_.assign(static_cast<std::size_t>(level.mesh.nodes()), 0.0);
  for (const auto& row : level.mesh.rows())
    for (int e = 0; e < row.length; ++e)
      for (const std::int64_t node : row.node)
        for (int side = 0; side < 2; ++side)
          stiffness_[node + e + side] += matrix_.coefficients()[row.element + e];
  sum_over_holders(level, stiffness_.data(), 1);
}

/// Cholesky factor of R^T W R, `weight` being W's entry of a node.
template <int Dim>
template <class Weight>
typename LaneFreeBody<Dim>::Factor LaneFreeBody<Dim>::factor_motions(Weight&& weight) const {
  std::array<double, static_cast<std::size_t>(motions) * motions> normal{};
  for (const auto& range : hierarchy_.level(0).counted)
    for (std::int64_t node = range.begin; node < range.end; ++node)
      for (int k = 0; k < motions; ++k)
        for (int l = 0; l <= k; ++l)
          for (int a = 0; a < Dim; ++a)
            normal[k * motions + l] += weight(node) * motion(k, node, a) * motion(l, node, a);
  sum_in_place(hierarchy_.level(0).comm, normal);
  Factor factor{};
  for (int row = 0; row < motions; ++row)
    for (int column = 0; column <= row; ++column) {
      double value = normal[row * motions + column];
      for (int k = 0; k < column; ++k) value -= factor[row][k] * factor[column][k];
      factor[row][column] = row == column ? std::sqrt(value) : value / factor[column][column];
    }
  return factor;
}

/// values -= W R (R^T W R)^-1 R^T values
template <int Dim>
template <class Real, class Weight>
void LaneFreeBody<Dim>::project(LaneValues<Real>& values, const Factor& factor, Weight&& weight) const {
  std::array<double, motions> amplitudes{};
  for (const auto& range : hierarchy_.level(0).counted)
    for (std::int64_t node = range.begin; node < range.end; ++node)
      for (int k = 0; k < motions; ++k)
        for (int a = 0; a < Dim; ++a) amplitudes[k] += motion(k, node, a) * values[node * Dim + a];
  sum_in_place(hierarchy_.level(0).comm, amplitudes);
  for (int row = 0; row < motions; ++row) {
    for (int k = 0; k < row; ++k) amplitudes[row] -= factor[row][k] * amplitudes[k];
    amplitudes[row] /= factor[row][row];
  }
  for (int row = motions - 1; row >= 0; --row) {
    for (int k = row + 1; k < motions; ++k) amplitudes[row] -= factor[k][row] * amplitudes[k];
    amplitudes[row] /= factor[row][row];
  }
  const std::int64_t nodes = hierarchy_.level(0).mesh.nodes();
  for (std::int64_t node = 0; node < nodes; ++node)
    for (int a = 0; a < Dim; ++a) {
      double value = values[node * Dim + a];  // what the motions take away may be all but a little of it
      for (int k = 0; k < motions; ++k) value -= weight(node) * amplitudes[k] * motion(k, node, a);
      values[node * Dim + a] = static_cast<Real>(value);
    }
}

template <int Dim>
void LaneFreeBody<Dim>::remove_motions(LaneValues<float>& displacement) const {
  project(displacement, of_displacements_, [](std::int64_t) { return 1.0; });
}

/// What is taken away acts where the body is stiff: forces in the void, be they rounding, would move it far.
template <int Dim>
void LaneFreeBody<Dim>::balance(LaneArray& forces) const {
  project(forces, of_forces_, [this](std::int64_t node) { return stiffness_[node]; });
}

template <int Dim>
SolveReport LaneFreeBody<Dim>::solve(std::span<const double> load, std::span<double> displacement,
                                     double tolerance, int max_iterations) {
  static const LogEvent event("fabseq free body");
  const auto scope = event.enter();
  const FlushToZero flush_to_zero;
  const int nodes = static_cast<int>(load.size() / Dim);
  LaneVector owned(nodes, Dim, 1);
  std::copy(load.begin(), load.end(), owned.values.begin());
  LaneArray rest, solution(matrix_.size(), 0.0);
  layout_.to_mesh(owned, 1, rest);
  balance(rest);
  auto square = matrix_.dot(rest.data(), rest.data());
  sum_in_place(matrix_.level().comm, square);
  // About 1, by a power of two: single precision shall hold the residual down to any tolerance.
  const double size = std::sqrt(square[0]);
  const double scale = std::isnormal(size) ? std::exp2(-std::ilogb(size)) : 1.0;
  for (double& value : rest) value *= scale;
  std::copy(rest.begin(), rest.end(), rounded_rest_.begin());
  State state;
  state.report = {0, 1.0, false, "iteration limit"};
  if (positive_) iterate(state, rest, solution, tolerance, max_iterations);
  for (double& value : solution) value /= scale;
  layout_.to_owned(solution, 1, owned);
  std::copy(owned.values.begin(), owned.values.end(), displacement.begin());
  return state.report;
}

/// Whether that is all: the residual is small enough, or no number.
template <int Dim>
bool LaneFreeBody<Dim>::judge(State& state, double size, double length, double tolerance) const {
  if (state.iteration == 0) state.start = size;
  const double reference = state.iteration == 0 ? state.start : std::min(state.start, length);
  SolveReport& report = state.report;
  report.iterations = state.iteration;
  report.residual = size == 0.0 ? 0.0 : std::sqrt(size / reference);
  report.converged =
      report.residual <= tolerance && report.residual <= error_factor * tolerance * state.spectrum.smallest();
  if (!std::isfinite(size)) report.reason = "not a number";
  return report.converged || !std::isfinite(size);
}

template <int Dim>
void LaneFreeBody<Dim>::iterate(State& state, LaneArray& rest, LaneArray& solution, double tolerance,
                                int max_iterations) {
  const MPI_Comm comm = matrix_.level().comm;
  while (true) {
    multigrid_.be_patient(state.iteration >= cycle_.patience);
    multigrid_.apply(rounded_rest_.data(), preconditioned_.data());
    remove_motions(preconditioned_);
    // The image is none before the first iteration: what it adds then is not used.
    const auto products =
        matrix_.dots(preconditioned_.data(), preconditioned_.data(), rest.data(), image_.data());
    std::array<double, 5> sums{products[0][0], products[1][0], products[2][0], state.length,
                               stop_requested() ? 1.0 : 0.0};
    sum_in_place(comm, sums);
    const auto& [size, decrease, overlap, length, asked] = sums;
    if (asked > 0.0) throw_stopped(comm);
    if (judge(state, size, length, tolerance) || state.iteration == max_iterations) return;
    const double beta = state.energy > 0.0 ? -overlap / state.energy : 0.0;
    for (std::size_t i = 0; i < direction_.size(); ++i)
      direction_[i] = preconditioned_[i] + (state.iteration > 0 ? beta * direction_[i] : 0.0);
    auto energy = matrix_.apply(direction_.data(), image_.data());
    sum_in_place(comm, energy);
    state.energy = energy[0];
    const double alpha = state.energy > 0.0 ? decrease / state.energy : 0.0;
    state.spectrum.add(alpha, beta);
    for (std::size_t i = 0; i < rest.size(); ++i) {
      solution[i] += alpha * direction_[i];
      rest[i] -= alpha * image_[i];
    }
    balance(rest);  // resultants that rounding leaves would stay, and outweigh what is left of the rest in
                    // the end
    std::copy(rest.begin(), rest.end(), rounded_rest_.begin());
    state.length = matrix_.dot(solution.data(), solution.data())[0];
    ++state.iteration;
  }
}

template class LaneFreeBody<2>;
template class LaneFreeBody<3>;

}  // namespace fabseq
