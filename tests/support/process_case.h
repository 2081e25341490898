/// \file
/// A small part with its process simulation, and the same simulation by dense matrices.
#pragma once

#include "fabseq/process/process_simulation.h"
#include "fabseq/solve/reference_elasticity.h"

#include "support/brute_force.h"
#include "support/small_parts.h"
#include <memory>
#include <utility>
#include <vector>

namespace fabseq::test {

inline const AssembledSolverSettings exact_solver = {ReferenceMethod::direct, 1e-13, 1000, "elasticity_"};

template <int Dim>
std::vector<double> isotropic_strain(double value) {
  std::vector<double> result(voigt_size<Dim>, 0.0);
  for (int a = 0; a < Dim; ++a) result[a] = value;
  return result;
}

/// What of a case may differ.
template <int Dim>
struct CaseSettings {
  Shape shape = gallows<Dim>();
  BuildPlate plate{Dim - 1, false};
  MaterialSettings material{1.0, 0.3, some_strain<Dim>()};
  ProcessSettings process{};
};

template <int Dim>
struct ProcessCase {
  explicit ProcessCase(const CaseSettings<Dim>& settings_)
      : settings(settings_),
        on_grid(odd_domain<Dim>(), settings.shape, settings.plate),
        model(on_grid.part, settings.material, settings.process),
        simulation(model,
                   std::make_unique<ReferenceElasticity<Dim>>(on_grid.grid, model.domain,
                                                              model.element.stiffness(), exact_solver),
                   groups, BlockSolver::one_by_one) {}

  const Part<Dim>& part() const { return on_grid.part; }
  const Grid<Dim>& grid() const { return on_grid.grid; }
  /// Distance of a point from the plate.
  double height(const Point<Dim>& x) const {
    const int axis = settings.plate.axis;
    return settings.plate.upper ? grid().domain().size[axis] - x[axis] : x[axis];
  }
  /// f(element number) of the height of its centre, 0 to 1, and of some noise: a wavy sequence.
  std::vector<double> wavy_time() const {
    return part_field(part(), [&](std::int64_t number) {
      const double h = height(grid().element_center(grid().all_elements().index(number)));
      return 0.85 * h / grid().domain().size[settings.plate.axis] + 0.1 * noise(number);
    });
  }
  std::vector<double> planar_time() const {
    return part_field(part(), [&](std::int64_t number) {
      return height(grid().element_center(grid().all_elements().index(number))) /
             grid().domain().size[settings.plate.axis];
    });
  }
  LayerDensities densities(const std::vector<double>& time, int count, double beta,
                           bool binary = false) const {
    return CurvedLayers(part().part_density(), uniform_time_points(count), beta, binary).densities(time);
  }
  std::vector<double> whole(std::span<const double> node_values) const {
    return whole_node_field<Dim>(grid(), node_values, Dim);
  }

  /// Stiffness (0: no element) and load factors of all elements of the grid in a layer.
  std::pair<std::vector<double>, std::vector<double>> element_factors(const LayerDensities& layers,
                                                                      int j) const {
    const auto& process = settings.process;
    std::vector<double> stiffness =
        whole_part_field(part(), layers.stage[j], process.void_model == VoidModel::quiet ? 0.0 : -1.0);
    for (double& value : stiffness)
      value = value < 0.0 ? 0.0
                          : process.min_stiffness +
                                (1.0 - process.min_stiffness) * std::pow(value, process.stiffness_penalty);
    std::vector<double> load = whole_part_field(part(), layers.layer[j]);
    for (double& value : load) value = std::pow(std::max(value, 0.0), process.strain_penalty);
    return {stiffness, load};
  }
  BruteForceElement<Dim> brute_force_element() const {
    return {grid().spacing(), grid().domain().thickness, settings.material.poisson};
  }
  /// Matrix of a layer, plate nodes fixed, for unit Young's modulus.
  DenseSystem<Dim> dense_system(const LayerDensities& layers, int j) const {
    const auto element = brute_force_element();
    const auto matrix = element.template matrix<element_unknowns<Dim>>(
        [&](int row, int column) { return element.stiffness(row, column); });
    const auto factors = element_factors(layers, j).first;
    DenseSystem<Dim> system(grid().domain().elements, Dim);
    grid().all_elements().for_each(
        [&](const Index<Dim>& index, std::int64_t e) { system.add(index, matrix, factors[e]); });
    system.nodes().for_each([&](const Index<Dim>& node, std::int64_t number) {
      for (int c = 0; part().on_plate(node) && c < Dim; ++c) system.fix(number * Dim + c);
    });
    return system;
  }
  std::vector<double> dense_load(const LayerDensities& layers, int j, const DenseSystem<Dim>& system) const {
    const auto factors = element_factors(layers, j).second;
    const auto strain = strain_tensor<Dim>(settings.material.inherent_strain);
    std::array<double, element_unknowns<Dim>> element_load{};
    for (int i = 0; i < element_unknowns<Dim>; ++i)
      element_load[i] = brute_force_element().strain_load(i, strain);
    std::vector<double> load(system.size(), 0.0);
    grid().all_elements().for_each([&](const Index<Dim>& index, std::int64_t e) {
      for (int i = 0; i < element_unknowns<Dim>; ++i)
        load[system.unknown(index, i)] += factors[e] * element_load[i];
    });
    return load;
  }
  /// Increment of every layer on all nodes.
  std::vector<std::vector<double>> dense_increments(const LayerDensities& layers) const {
    std::vector<std::vector<double>> result;
    for (int j = 0; j < layers.count(); ++j) {
      const auto system = dense_system(layers, j);
      result.push_back(system.solve(dense_load(layers, j, system)));
    }
    return result;
  }

  CaseSettings<Dim> settings;
  PartOnGrid<Dim> on_grid;
  ElasticModel<Dim> model;
  LayerGroups groups{PETSC_COMM_WORLD, 1};
  ProcessSimulation<Dim> simulation;
};

/// Cases with the void absent and quiet.
template <int Dim>
std::vector<CaseSettings<Dim>> void_models() {
  std::vector<CaseSettings<Dim>> result(2);
  result[1].process.void_model = VoidModel::quiet;
  return result;
}

}  // namespace fabseq::test
