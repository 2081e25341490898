// SPDX-License-Identifier: MIT
/// \file
/// A small part with its process simulation, and the same simulation by dense matrices.
#pragma once

#include "fabseq/layers/curved_layers.h"
#include "fabseq/process/elastic_process.h"
#include "fabseq/process/inherent_strain.h"
#include "fabseq/solve/reference/reference_elasticity.h"
#include "support/brute_force.h"
#include "support/small_parts.h"

#include <memory>
#include <optional>
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
  std::optional<Shape> substrate = std::nullopt, clamps = std::nullopt;
  MaterialSettings material{1.0, 0.3, some_strain<Dim>()};
  ProcessSettings process{.deposition = DepositionModel::follow};
};

template <int Dim>
struct ProcessCase {
  explicit ProcessCase(const CaseSettings<Dim>& settings_)
      : settings(settings_),
        on_grid(odd_domain<Dim>(), describe(settings), settings.plate),
        supports(on_grid.part, on_grid.description),
        model(on_grid.part, supports, settings.material, settings.process),
        simulation(model,
                   std::make_unique<ReferenceElasticity<Dim>>(on_grid.grid, model.domain,
                                                              model.element.stiffness(), exact_solver),
                   groups, BlockSolver::one_by_one) {}

  static PartDescription describe(const CaseSettings<Dim>& settings) {
    PartDescription result{settings.shape, false};
    result.substrate = settings.substrate;
    result.clamps = settings.clamps;
    return result;
  }
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
    LayerDensities result;
    CurvedLayers(part().part_density(), uniform_time_points(count), beta, binary).set_densities(time, result);
    return result;
  }
  const ProcessResult& simulate(const LayerDensities& layers) { return simulation.simulate(layers, strain); }
  const ProcessResult& simulate(const LayerDensities& layers, const StrainSource<Dim>& strains) {
    return simulation.simulate(layers, strains);
  }
  /// Simulates a step that adds each layer, one in which what stands is strained, and a last of that kind.
  const ProcessResult& simulate_cooling(const LayerDensities& layers, const StrainSource<Dim>& strains) {
    return simulation.simulate({layers, strains, cooling_steps(layers.count())});
  }
  static std::vector<BuildStep> cooling_steps(int layers) {
    std::vector<BuildStep> result;
    for (int layer = 0; layer < layers; ++layer)
      for (const bool adds : {true, false}) result.push_back({layer, adds});
    result.push_back({layers - 1, false});
    return result;
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
    const auto& substrate = part().substrate().elements();
    const auto stands =
        whole_element_field<Dim>(grid(), std::vector<double>(substrate.begin(), substrate.end()));
    for (std::size_t e = 0; e < stands.size(); ++e)
      if (stands[e] != 0.0) stiffness[e] = 1.0;
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
      for (int c = 0; is_held(node) && c < Dim; ++c) system.fix(number * Dim + c);
    });
    return system;
  }
  bool is_held(const Index<Dim>& node) const {
    if (!settings.clamps) return part().on_plate(node);
    return settings.clamps->contains(grid().node_position(node), 1e-9);
  }
  /// `strains`: of all elements, [element][Voigt]; empty: the material's.
  std::vector<double> dense_load(const LayerDensities& layers, int j, const DenseSystem<Dim>& system,
                                 const std::vector<double>& strains = {}) const {
    const auto factors = element_factors(layers, j).second;
    std::vector<double> load(system.size(), 0.0);
    grid().all_elements().for_each([&](const Index<Dim>& index, std::int64_t e) {
      if (factors[e] == 0.0) return;
      const auto own = strains.begin() + e * (strains.empty() ? 0 : voigt_size<Dim>);
      const auto strain =
          strain_tensor<Dim>(strains.empty() ? settings.material.inherent_strain
                                             : std::vector<double>(own, own + voigt_size<Dim>));
      for (int i = 0; i < element_unknowns<Dim>; ++i)
        load[system.unknown(index, i)] += factors[e] * brute_force_element().strain_load(i, strain);
    });
    return load;
  }
  /// Increment of every layer on all nodes.
  std::vector<std::vector<double>> dense_increments(const LayerDensities& layers,
                                                    const std::vector<double>& strains = {}) const {
    std::vector<std::vector<double>> result;
    for (int j = 0; j < layers.count(); ++j) {
      const auto system = dense_system(layers, j);
      result.push_back(system.solve(dense_load(layers, j, system, strains)));
    }
    return result;
  }

  CaseSettings<Dim> settings;
  PartOnGrid<Dim> on_grid;
  Supports<Dim> supports;
  ElasticModel<Dim> model;
  InherentStrain<Dim> strain{settings.material, 1.0};
  LayerGroups groups{PETSC_COMM_WORLD, 1};
  ElasticProcess<Dim> simulation;
};

/// What the release adds to the last simulation.
template <int Dim>
std::vector<double> release(const ProcessCase<Dim>& process, const LayerDensities& layers) {
  return Release<Dim>(process.model, {exact_solver}).displacement(process.simulation.reactions(layers));
}

inline LayerDensities moved(const LayerDensities& layers, double step, const LayerDensities& direction,
                            bool stage) {
  LayerDensities result = layers;
  for (int j = 0; j < layers.count(); ++j) {
    if (stage)
      result.stage[j] = moved(layers.stage[j], step, direction.stage[j]);
    else
      result.layer[j] = moved(layers.layer[j], step, direction.layer[j]);
  }
  return result;
}

/// A direction proportional to the densities, so that they stay positive on the way.
template <int Dim>
LayerDensities direction_of(const Part<Dim>& part, const LayerDensities& layers) {
  LayerDensities direction = layers;
  for (int j = 0; j < layers.count(); ++j) {
    const auto s = noise_field(part, -1.0, 1.0, 2 * j), l = noise_field(part, -1.0, 1.0, 2 * j + 1);
    for (std::size_t e = 0; e < s.size(); ++e) {
      direction.stage[j][e] *= s[e];
      direction.layer[j][e] *= l[e];
    }
  }
  return direction;
}

/// A strain of its own in every part element, [part element][Voigt].
template <int Dim>
std::vector<double> noisy_strains(const Part<Dim>& part, int salt = 5) {
  std::vector<double> result(part.elements().size() * voigt_size<Dim>);
  for (int c = 0; c < voigt_size<Dim>; ++c) {
    const auto component = noise_field(part, -0.01, 0.01, salt + c);
    for (std::size_t e = 0; e < component.size(); ++e) result[e * voigt_size<Dim> + c] = component[e];
  }
  return result;
}
/// The same on all elements of the grid. Collective.
template <int Dim>
std::vector<double> whole_strains(const Part<Dim>& part, const std::vector<double>& strains) {
  constexpr int components = voigt_size<Dim>;
  const auto elements = static_cast<std::size_t>(part.grid().owned_elements().count());
  std::vector<double> owned(elements * components, 0.0);
  for (std::size_t e = 0; e < part.elements().size(); ++e)
    for (int c = 0; c < components; ++c)
      owned[part.elements()[e] * components + c] = strains[e * components + c];
  return whole_element_field<Dim>(part.grid(), owned, components);
}

/// The gallows on a substrate, which is clamped at one end, with the void absent and quiet.
template <int Dim>
std::vector<CaseSettings<Dim>> clamped_cases() {
  const auto size = odd_domain<Dim>().size;
  std::vector<double> low(Dim, 0.0), high(size.begin(), size.end()), end(size.begin(), size.end());
  high[Dim - 1] = end[Dim - 1] = 0.3 * size[Dim - 1];  // one layer of elements or two
  end[0] = 0.0;
  std::vector<CaseSettings<Dim>> result(2);
  for (auto& settings : result) {
    settings.substrate = box(low, high);
    settings.clamps = box(low, end);
  }
  result[1].process.void_model = VoidModel::quiet;
  return result;
}

/// Cases with the void absent and quiet.
template <int Dim>
std::vector<CaseSettings<Dim>> void_models() {
  std::vector<CaseSettings<Dim>> result(2);
  result[1].process.void_model = VoidModel::quiet;
  return result;
}

}  // namespace fabseq::test
