#include "fabseq/process/residual_stress.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Calls f(model element, its displacements, part element or -1) with the increments of a layer for the elements
/// that `wanted` says.
template <int Dim, class Function>
void for_each_element(const ProcessSimulation<Dim>& simulation, int layer, const std::vector<char>& wanted,
                      Function&& f) {
  const ElasticModel<Dim>& model = simulation.model();
  const Grid<Dim>& grid = model.part.grid();
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * Dim);
  grid.exchange(Dim).to_ghosted(simulation.increment(layer), ghosted);
  std::vector<int> part_element(model.domain.first_corners.size(), -1);
  for (std::size_t e = 0; e < model.part_position.size(); ++e)
    part_element[model.part_position[e]] = static_cast<int>(e);
  std::array<double, element_unknowns<Dim>> displacement{};
  for (std::size_t element = 0; element < part_element.size(); ++element) {
    if (wanted[element] == 0) continue;
    for (int i = 0; i < element_unknowns<Dim>; ++i) {
      const std::size_t node = model.domain.first_corners[element] + grid.corner_offsets()[i / Dim];
      displacement[i] = ghosted[node * Dim + i % Dim];
    }
    f(element, displacement, part_element[element]);
  }
}

/// Whether an element of the model has a fixed node.
template <int Dim>
std::vector<char> touches_plate(const ElasticModel<Dim>& model) {
  const Grid<Dim>& grid = model.part.grid();
  std::vector<double> fixed(model.domain.fixed.begin(), model.domain.fixed.end());
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * Dim);
  grid.exchange(Dim).to_ghosted(fixed, ghosted);
  std::vector<char> result;
  for (const int first_corner : model.domain.first_corners)
    result.push_back(std::any_of(grid.corner_offsets().begin(), grid.corner_offsets().end(), [&](int offset) {
      return ghosted[static_cast<std::size_t>(first_corner + offset) * Dim] != 0.0;
    }));
  return result;
}

}  // namespace

template <int Dim>
std::vector<double> residual_stress(const ProcessSimulation<Dim>& simulation,
                                    const LayerDensities& densities) {
  const ElasticModel<Dim>& model = simulation.model();
  const auto strain_stress = model.element.stress(model.material.inherent_strain);
  const bool whole_box = model.domain.first_corners.size() != model.part.first_corners().size();
  std::vector<double> stress(
      static_cast<std::size_t>(model.part.grid().owned_elements().count()) * voigt_size<Dim>, 0.0);
  const std::vector<char> all(model.domain.first_corners.size(), 1);
  for (int layer = 0; layer < densities.count(); ++layer)
    for_each_element(simulation, layer, all,
                     [&](std::size_t element, const auto& displacement, int part_element) {
                       const double stage = part_element < 0 ? 0.0 : densities.stage[layer][part_element];
                       const double added = part_element < 0 ? 0.0 : densities.layer[layer][part_element];
                       const auto elastic = model.element.center_stress(displacement);
                       const std::size_t position = whole_box ? element : model.part.elements()[element];
                       for (int c = 0; c < voigt_size<Dim>; ++c)
                         stress[position * voigt_size<Dim> + c] +=
                             model.material.young *
                             (model.stiffness(stage) * elastic[c] - model.load(added) * strain_stress[c]);
                     });
  return stress;
}

template <int Dim>
std::vector<double> plate_reactions(const ProcessSimulation<Dim>& simulation,
                                    const LayerDensities& densities) {
  constexpr int unknowns = element_unknowns<Dim>;
  const ElasticModel<Dim>& model = simulation.model();
  const Grid<Dim>& grid = model.part.grid();
  const auto& stiffness = model.element.stiffness();
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * Dim, 0.0);
  std::vector<double> reactions(model.domain.fixed.size());
  const std::vector<char> at_plate = touches_plate(model);
  for (int layer = 0; layer < densities.count(); ++layer)
    for_each_element(
        simulation, layer, at_plate, [&](std::size_t element, const auto& displacement, int part_element) {
          const double factor =
              model.stiffness(part_element < 0 ? 0.0 : densities.stage[layer][part_element]);
          const double load = part_element < 0 ? 0.0 : model.load(densities.layer[layer][part_element]);
          for (int i = 0; i < unknowns; ++i) {
            double force = -load * model.strain_load[i];
            for (int j = 0; j < unknowns; ++j)
              force += factor * stiffness[i * unknowns + j] * displacement[j];
            const std::size_t node = model.domain.first_corners[element] + grid.corner_offsets()[i / Dim];
            ghosted[node * Dim + i % Dim] += force;
          }
        });
  grid.exchange(Dim).add_to_owned(ghosted, reactions);
  // Elsewhere forces are left that are no reactions.
  for (std::size_t i = 0; i < reactions.size(); ++i)
    if (model.domain.fixed[i] == 0) reactions[i] = 0.0;
  return reactions;
}

#define FABSEQ_INSTANTIATE(Dim)                                                                            \
  template std::vector<double> residual_stress<Dim>(const ProcessSimulation<Dim>&, const LayerDensities&); \
  template std::vector<double> plate_reactions<Dim>(const ProcessSimulation<Dim>&, const LayerDensities&);
FABSEQ_INSTANTIATE(2)
FABSEQ_INSTANTIATE(3)
#undef FABSEQ_INSTANTIATE

}  // namespace fabseq
