// SPDX-License-Identifier: MIT
#include "fabseq/process/elastic_model.h"

namespace fabseq {

template <int Dim>
std::vector<int> touched_nodes(const Grid<Dim>& grid, const std::vector<int>& elements) {
  const std::vector<char> touched = nodes_of_elements(grid, elements);
  std::vector<int> result;
  for (std::size_t node = 0; node < touched.size(); ++node)
    if (touched[node] != 0) result.push_back(static_cast<int>(node));
  return result;
}

template <int Dim>
ElasticModel<Dim>::ElasticModel(const Part<Dim>& part_, const Supports<Dim>& supports_,
                                const MaterialSettings& material_, const ProcessSettings& settings_)
    : part(part_),
      supports(supports_),
      material(material_),
      settings(settings_),
      element(part.grid().spacing(), part.grid().domain().thickness, material.poisson) {
  for (int c = 0; c < voigt_size<Dim>; ++c) {
    std::array<double, voigt_size<Dim>> strain{};
    strain[c] = 1.0;
    unit_loads[c] = element.strain_load(strain);
  }

  const Grid<Dim>& grid = part.grid();
  domain.components = Dim;
  part_position.resize(part.elements().size());
  std::size_t next = 0;
  grid.owned_elements().for_each([&](const Index<Dim>& index, std::int64_t offset) {
    const bool in_part = next < part.elements().size() && part.elements()[next] == offset;
    const bool stands = part.substrate().elements()[offset] != 0;
    if (!in_part && !stands && settings.void_model == VoidModel::absent) return;
    if (in_part) part_position[next] = static_cast<int>(elements.size());
    part_element.push_back(in_part ? static_cast<int>(next++) : stands ? in_substrate : in_void);
    elements.push_back(static_cast<int>(offset));
    domain.first_corners.push_back(grid.first_corner(index));
  });
  nodes = touched_nodes(grid, elements);
  domain.fixed.resize(static_cast<std::size_t>(grid.owned_nodes().count()) * Dim);
  for (std::size_t node = 0; node < supports.held.size(); ++node)
    std::fill_n(domain.fixed.begin() + static_cast<std::ptrdiff_t>(node * Dim), Dim, supports.held[node]);
}

template <int Dim>
std::vector<double> ElasticModel<Dim>::at_nodes(std::span<const double> field) const {
  std::vector<double> result;
  result.reserve(nodes.size() * Dim);
  for (const int node : nodes)
    for (int axis = 0; axis < Dim; ++axis)
      result.push_back(field[static_cast<std::size_t>(node) * Dim + axis]);
  return result;
}

template <int Dim>
std::vector<double> ElasticModel<Dim>::on_all_nodes(std::span<const double> values) const {
  std::vector<double> result(domain.fixed.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i)
    result[static_cast<std::size_t>(nodes[i / Dim]) * Dim + i % Dim] = values[i];
  return result;
}

template <int Dim>
std::vector<double> ElasticModel<Dim>::finished_stiffness() const {
  std::vector<double> result(elements.size());
  for (std::size_t e = 0; e < result.size(); ++e)
    result[e] = stiffness(stage_density(part.part_density(), e));
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(touched_nodes);
FABSEQ_INSTANTIATE_STRUCT(ElasticModel);

}  // namespace fabseq
