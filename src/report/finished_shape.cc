// SPDX-License-Identifier: MIT
#include "fabseq/report/finished_shape.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/chain/stages.h"
#include "fabseq/grid/element_halo.h"
#include "fabseq/part/rigid_motions.h"
#include "fabseq/process/release.h"
#include "fabseq/responses/response_type.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fabseq {

namespace {

/// Outward normals of the part's skin at the owned nodes, [node][axis], of length 1; 0 inside and outside.
template <int Dim>
std::vector<double> skin_normals(const Part<Dim>& part) {
  const Grid<Dim>& grid = part.grid();
  const ElementHalo<Dim> halo(grid, 1);
  const std::vector<double> solid =
      halo.gather(part.expand(std::vector<double>(part.elements().size(), 1.0)));
  std::vector<double> normals(static_cast<std::size_t>(grid.owned_nodes().count()) * Dim, 0.0);
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    if (part.touched_nodes()[offset] == 0) return;
    std::array<int, Dim> away{};  // from its elements, in units of their edges; whole: inside, it vanishes
    for (int number = 0; number < 1 << Dim; ++number) {
      const Index<Dim> element = stepped<Dim>(node, number, -1);
      if (!halo.box().contains(element) || solid[halo.box().offset(element)] == 0.0) continue;
      for (int axis = 0; axis < Dim; ++axis) away[axis] += (number >> axis & 1) != 0 ? 1 : -1;
    }
    double* normal = &normals[static_cast<std::size_t>(offset) * Dim];
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) {
      normal[axis] = away[axis] / grid.spacing()[axis];
      square += normal[axis] * normal[axis];
    }
    for (int axis = 0; axis < Dim && square > 0.0; ++axis) normal[axis] /= std::sqrt(square);
  });
  return normals;
}

/// Measures the displacement on the owned nodes that `counts` marks.
template <int Dim>
DisplacementSize size_on(const std::vector<char>& counts, const Part<Dim>& part,
                         const std::vector<double>& displacement) {
  double largest = 0.0, total = 0.0, count = 0.0;
  for (std::size_t node = 0; node < counts.size(); ++node) {
    if (counts[node] == 0) continue;
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) square += std::pow(displacement[node * Dim + axis], 2);
    largest = std::max(largest, std::sqrt(square));
    total += square;
    count += 1.0;
  }
  const MPI_Comm comm = part.grid().comm();
  return {max(comm, largest), std::sqrt(sum(comm, total) / sum(comm, count))};
}

/// Fits the motion of a body that grows evenly, s (x - c), to displacements of the skin that no rigid motion
/// makes smaller. A drawing that is smaller by s makes up for it.
template <int Dim>
ScaledDrawing scaled_drawing(const Grid<Dim>& grid, const std::vector<int>& skin,
                             const std::vector<double>& displacement) {
  std::vector<double> sums(Dim + 1, 0.0);  // of the positions, and the number of nodes
  const auto position = [&](int node) { return grid.node_position(grid.owned_nodes().index(node)); };
  for (const int node : skin) {
    const Point<Dim> x = position(node);
    for (int axis = 0; axis < Dim; ++axis) sums[axis] += x[axis];
    sums[Dim] += 1.0;
  }
  sum_in_place(grid.comm(), sums);
  std::vector<double> products(3, 0.0);  // u . (x - c), |x - c|^2, |u|^2
  for (const int node : skin) {
    const Point<Dim> x = position(node);
    for (int axis = 0; axis < Dim; ++axis) {
      const double u = displacement[static_cast<std::size_t>(node) * Dim + axis];
      const double r = x[axis] - sums[axis] / sums[Dim];
      products[0] += u * r;
      products[1] += r * r;
      products[2] += u * u;
    }
  }
  sum_in_place(grid.comm(), products);
  const double growth = products[1] > 0.0 ? products[0] / products[1] : 0.0;
  return {1.0 - growth, std::sqrt(std::max(0.0, products[2] - growth * products[0]) / sums[Dim])};
}

/// Largest deviation of the skin along its normal to either side, after the best rigid fit.
template <int Dim>
void measure_stock(const Part<Dim>& part, std::vector<double> displacement, Deviation& deviation) {
  const std::vector<double> normals = skin_normals(part);
  std::vector<int> skin;
  for (std::size_t node = 0; node < part.touched_nodes().size(); ++node)
    if (std::any_of(&normals[node * Dim], &normals[node * Dim] + Dim, [](double x) { return x != 0.0; }))
      skin.push_back(static_cast<int>(node));
  const RigidMotions<Dim> motions(part.grid(), skin);
  if (motions.determined()) motions.remove_fit(displacement);
  for (const int node : skin) {
    double along = 0.0;
    for (int axis = 0; axis < Dim; ++axis)
      along += displacement[static_cast<std::size_t>(node) * Dim + axis] *
               normals[static_cast<std::size_t>(node) * Dim + axis];
    deviation.outward = std::max(deviation.outward, along);
    deviation.inward = std::max(deviation.inward, -along);
  }
  std::vector<char> on_skin(part.touched_nodes().size(), 0);
  for (const int node : skin) on_skin[node] = 1;
  deviation.skin = size_on(on_skin, part, displacement);
  deviation.scaled = scaled_drawing(part.grid(), skin, displacement);
  deviation.outward = max(part.grid().comm(), deviation.outward);
  deviation.inward = max(part.grid().comm(), deviation.inward);
}

/// Marks the owned nodes of all node sets that the objective measures; none if it measures none.
template <int Dim>
std::optional<std::vector<char>> measured_nodes(const Model<Dim>& model) {
  std::optional<std::vector<char>> result;
  for (const Term& term : model.settings.objective)
    for (const std::string& name : term.type->facts(term).node_sets) {
      if (!result) result.emplace(model.part.touched_nodes().size(), 0);
      for (const int node : model.node_sets.at(name).owned) (*result)[node] = 1;
    }
  return result;
}

template <int Dim>
Deviation deviation_of(const Model<Dim>& model, const std::vector<double>& displacement) {
  Deviation result;
  static_cast<DisplacementSizes&>(result) = displacement_sizes(model, displacement);
  measure_stock(model.part, displacement, result);
  return result;
}

/// What the release adds; empty where the part would fall apart, and, with `failure` the reason, if the solve
/// fails: what was simulated shall not be lost.
template <int Dim>
std::vector<double> release_displacement(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                                         const StageResults<Dim>& state, std::string& failure) {
  if (!release_obstacle(model.grid, model.supports, model.settings.process.void_model).empty()) return {};
  const SolverSettings& solver = model.settings.solver;
  try {
    return pipeline.process().release_displacement(*state.densities,
                                                   release_solver(solver, solver.finest_tolerance()));
  } catch (const NumericalError& error) {
    failure = error.what();
    return {};
  }
}

}  // namespace

template <int Dim>
DisplacementSizes displacement_sizes(const Model<Dim>& model, const std::vector<double>& displacement) {
  DisplacementSizes result;
  result.part = size_on(model.part.touched_nodes(), model.part, displacement);
  if (const auto nodes = measured_nodes(model)) result.nodes = size_on(*nodes, model.part, displacement);
  return result;
}

template <int Dim>
FinishedShape finished_shape(const Model<Dim>& model, const Pipeline<Dim>& pipeline,
                             const StageResults<Dim>& state) {
  FinishedShape result;
  std::vector<double> displacement = state.process->displacement;
  result.as_built = deviation_of(model, displacement);
  const std::vector<double> release = release_displacement(model, pipeline, state, result.failure);
  if (release.empty()) return result;
  add_scaled(displacement, 1.0, release);
  result.released = deviation_of(model, displacement);
  result.release = pipeline.process().model().at_nodes(release);
  result.released_displacement = pipeline.process().model().at_nodes(displacement);
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(displacement_sizes);
FABSEQ_INSTANTIATE_FUNCTION(finished_shape);

}  // namespace fabseq
