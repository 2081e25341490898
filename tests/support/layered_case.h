// SPDX-License-Identifier: MIT
/// \file
/// Layers of a part as the process hands them to an elasticity solver (docs/formulation.md 4.1), and the
/// reference path's solutions.
#pragma once

#include "fabseq/config/config.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/layers/curved_layers.h"
#include "solve/lane_elasticity.h"
#include "support/brute_force.h"
#include "support/small_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace fabseq::test {

/// What of a case may differ.
template <int Dim>
struct LayeredSettings {
  Domain<Dim> domain;
  Shape shape;
  BuildPlate plate{Dim - 1, false};
  VoidModel void_model = VoidModel::absent;
  int layers = 8;
  double beta = 40.0;
  double wave = 0.1;  ///< of the pseudo-time: beyond 0.2 layers fall apart into islands
};

/// V-shape of Di Girolamo 2024 in a box of 2 x 1 x 2 (2D: 2 x 2).
template <int Dim>
Shape v_shape() {
  Shape cut;
  cut.kind = Shape::Kind::half_space;
  cut.first.assign(Dim, 0.0);
  cut.first[0] = 1.0;
  cut.second.assign(Dim, 0.0);
  cut.second[0] = -1.0;
  cut.second[Dim - 1] = 1.0;
  std::vector<double> low(Dim, 0.0), foot(Dim, 1.0), leg(Dim, 0.0), high(Dim, 1.0);
  foot[0] = high[0] = high[Dim - 1] = 2.0;
  foot[Dim - 1] = 0.6;
  leg[0] = 1.2;
  return combine(Shape::Kind::difference, {union_of({box(low, foot), box(leg, high)}), cut});
}
template <int Dim>
Domain<Dim> v_domain(const Index<Dim>& elements) {
  if constexpr (Dim == 2)
    return {{2.0, 2.0}, elements, 0.25};
  else
    return {{2.0, 1.0, 2.0}, elements, 1.0};
}

template <int Dim>
struct LayeredCase {
  explicit LayeredCase(const LayeredSettings<Dim>& settings_, MPI_Comm comm = PETSC_COMM_WORLD)
      : settings(settings_), on_grid(settings.domain, settings.shape, settings.plate, comm) {
    domain.components = Dim;
    const bool quiet = settings.void_model == VoidModel::quiet;
    const auto part = on_grid.part.expand(std::vector<double>(on_grid.part.elements().size(), 1.0));
    const auto time = part_field(on_grid.part, [&](std::int64_t number) { return wavy_time(number); });
    const CurvedLayers curved(on_grid.part.part_density(), uniform_time_points(settings.layers),
                              settings.beta, false);
    LayerDensities densities;
    curved.set_densities(time, densities);
    std::vector<std::vector<double>> stage, layer;
    for (int j = 0; j < settings.layers; ++j) {
      stage.push_back(on_grid.part.expand(densities.stage[j]));
      layer.push_back(on_grid.part.expand(densities.layer[j]));
    }
    const Grid<Dim>& grid = on_grid.grid;
    std::vector<double> ghosted(grid.ghosted_nodes().count() * Dim * settings.layers, 0.0);
    const auto element_load = unit_load();
    grid.owned_elements().for_each([&](const Index<Dim>& index, std::int64_t offset) {
      if (!quiet && part[offset] == 0.0) return;
      const int first = grid.first_corner(index);
      domain.first_corners.push_back(first);
      for (int j = 0; j < settings.layers; ++j) {
        stiffness.push_back(1e-9 + (1.0 - 1e-9) * std::pow(stage[j][offset], 3.0));
        const double factor = std::pow(std::max(layer[j][offset], 0.0), 3.0);
        for (int i = 0; i < element_unknowns<Dim>; ++i) {
          const int unknown = (first + grid.corner_offsets()[i / Dim]) * Dim + i % Dim;
          ghosted[unknown * settings.layers + j] += factor * element_load[i];
        }
      }
    });
    load = zeros();
    grid.exchange(Dim * settings.layers).add_to_owned(ghosted, load.values);
    grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t) {
      domain.fixed.insert(domain.fixed.end(), Dim, on_grid.part.on_plate(node) ? 1 : 0);
    });
  }

  /// Rises from the plate, with waves.
  double wavy_time(std::int64_t number) const {
    const Grid<Dim>& grid = on_grid.grid;
    const auto center = grid.element_center(grid.all_elements().index(number));
    double height = center[settings.plate.axis] / settings.domain.size[settings.plate.axis];
    if (settings.plate.upper) height = 1.0 - height;
    double wave = settings.wave;
    for (int axis = 0; axis < Dim; ++axis)
      wave *=
          std::sin((3.0 + axis) * center[axis] / settings.domain.size[axis] * std::numbers::pi + 0.3 * axis);
    return std::clamp(0.05 + 0.9 * height + wave, 0.0, 1.0);
  }
  std::vector<double> unit_load() const {
    std::vector<double> strain(voigt_size<Dim>, 0.0), result;
    for (int a = 0; a < Dim; ++a) strain[a] = -0.01;
    for (int i = 0; i < element_unknowns<Dim>; ++i)
      result.push_back(element().strain_load(i, strain_tensor<Dim>(strain)));
    return result;
  }
  BruteForceElement<Dim> element() const {
    return {on_grid.grid.spacing(), settings.domain.thickness, poisson};
  }
  LaneVector zeros() const {
    return {static_cast<int>(on_grid.grid.owned_nodes().count()), Dim, settings.layers};
  }
  LaneElasticity<Dim> lanes(const LaneCycle& cycle = {}, double tolerance = 1e-9,
                            int max_iterations = 200) const {
    return LaneElasticity<Dim>(on_grid.grid, domain, poisson, cycle, max_iterations,
                               {ReferenceMethod::direct, tolerance, 1000, "test_"});
  }
  /// Displacements of all layers, [layer][node][component] on the whole grid, good to ten digits and more: by
  /// factorization, with residuals in long double. The assembled matrix by itself is not enough where stiff
  /// islands float in soft surroundings: the rounding of its entries holds them in place (errors of 1e-4).
  /// Collective: the first rank works for all.
  static std::vector<std::vector<double>> exact(const LayeredSettings<Dim>& settings) {
    IndexBox<Dim> nodes{{}, settings.domain.elements};
    for (int& extent : nodes.size) ++extent;
    const auto unknowns = static_cast<std::size_t>(nodes.count() * Dim);
    std::vector<std::vector<double>> result(settings.layers, std::vector<double>(unknowns));
    if (rank_of(PETSC_COMM_WORLD) == 0) result = exact_on_one_rank(settings);
    for (auto& layer : result)
      MPI_Bcast(layer.data(), static_cast<int>(unknowns), MPI_DOUBLE, 0, PETSC_COMM_WORLD);
    return result;
  }
  static std::vector<std::vector<double>> exact_on_one_rank(const LayeredSettings<Dim>& settings) {
    const LayeredCase whole(settings, MPI_COMM_SELF);
    const int layers = settings.layers;
    const ElementMatrices<Dim> matrices(whole.on_grid.grid.spacing(), settings.domain.thickness, poisson);
    ReferenceElasticity<Dim> solver(whole.on_grid.grid, whole.domain, matrices.stiffness(),
                                    {ReferenceMethod::direct, 1e-13, 1000, "test_"});
    solver.set_operators(0, layers, whole.stiffness, true);
    std::vector<long double> sum(whole.load.values.size(), 0.0L);
    for (int step = 0; step < 3; ++step) {
      const LaneVector residual = whole.residual(sum);
      LaneVector correction = whole.zeros();
      solver.solve({&residual, 1}, {&correction, 1});
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += correction.values[i];
    }
    std::vector<std::vector<double>> result(layers);
    for (std::size_t i = 0; i < sum.size(); ++i) result[i % layers].push_back(static_cast<double>(sum[i]));
    return result;
  }
  /// f - K u on a grid that one rank has whole.
  LaneVector residual(const std::vector<long double>& displacement) const {
    constexpr int unknowns = element_unknowns<Dim>;
    const BruteForceElement<Dim, long double> precise{on_grid.grid.spacing(), settings.domain.thickness,
                                                      poisson};
    const auto matrix = precise.template matrix<unknowns>(
        [&](int row, int column) { return precise.stiffness(row, column); });
    std::vector<long double> rest(load.values.begin(), load.values.end());
    for (std::size_t e = 0; e < domain.first_corners.size(); ++e)
      for (int row = 0; row < unknowns; ++row)
        for (int j = 0; j < settings.layers; ++j) {
          long double force = 0.0L;
          for (int column = 0; column < unknowns; ++column)
            force += matrix[row * unknowns + column] * displacement[place(e, column, j)];
          rest[place(e, row, j)] -= stiffness[e * settings.layers + j] * force;
        }
    LaneVector result = zeros();
    std::copy(rest.begin(), rest.end(), result.values.begin());
    return result;
  }
  /// Place of an element's unknown in a vector on all nodes.
  std::size_t place(std::size_t element, int unknown, int layer) const {
    const int node = domain.first_corners[element] + on_grid.grid.corner_offsets()[unknown / Dim];
    return (static_cast<std::size_t>(node) * Dim + unknown % Dim) * settings.layers + layer;
  }
  std::vector<double> whole(const LaneVector& values, int lane) const {
    return whole_node_field<Dim>(on_grid.grid, values.lane(lane), Dim);
  }

  static constexpr double poisson = 0.3;
  LayeredSettings<Dim> settings;
  PartOnGrid<Dim> on_grid;
  SystemDomain domain;
  std::vector<double> stiffness;  ///< [element of the domain][layer]
  LaneVector load;
};

}  // namespace fabseq::test
