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
  common_strain.fill(1.0);
  if (!material.turning_strain) {
    strain_load = element.strain_load(material.inherent_strain);
    std::copy_n(material.inherent_strain.begin(), common_strain.size(), common_strain.begin());
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

template <int Dim>
std::array<double, voigt_size<Dim>> ElasticModel<Dim>::strain_of(const StrainField& strains,
                                                                 std::size_t number, int layer) const {
  constexpr std::size_t components = voigt_size<Dim>;
  std::array<double, components> result = common_strain;
  for (std::size_t c = 0; c < components; ++c) {
    if (!strains.of_elements.empty()) result[c] = strains.of_elements[number * components + c];
    if (!strains.of_layers.empty())
      result[c] *= strains.of_layers[static_cast<std::size_t>(layer) * components + c];
  }
  return result;
}

template <int Dim>
std::vector<double> ElasticModel<Dim>::strain_when_built(const StrainField& strains,
                                                         std::span<const double> layer) const {
  std::vector<double> result;
  if (strains.uniform()) return result;
  result.reserve(layer.size() * voigt_size<Dim>);
  for (std::size_t e = 0; e < layer.size(); ++e) {
    const auto strain = strain_of(strains, e, static_cast<int>(layer[e]) - 1);
    result.insert(result.end(), strain.begin(), strain.end());
  }
  return result;
}

template <int Dim>
typename ElasticModel<Dim>::ElementLoad ElasticModel<Dim>::unit_load(const StrainField& strains,
                                                                     const StrainFactors<Dim>& factors,
                                                                     std::size_t number, int layer) const {
  if (strains.uniform()) return material_load(factors);
  return load_of(strain_of(strains, number, layer), factors);
}

template <int Dim>
typename ElasticModel<Dim>::ElementLoad ElasticModel<Dim>::material_load(
    const StrainFactors<Dim>& factors) const {
  if (factors == no_change<Dim>() || material.turning_strain) return strain_load;
  return load_of(material.inherent_strain, factors);
}

template <int Dim>
typename ElasticModel<Dim>::ElementLoad ElasticModel<Dim>::load_of(std::span<const double> strain,
                                                                   const StrainFactors<Dim>& factors) const {
  ElementLoad result{};
  for (int c = 0; c < voigt_size<Dim>; ++c)
    for (int i = 0; i < element_unknowns<Dim>; ++i) result[i] += factors[c] * strain[c] * unit_loads[c][i];
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(touched_nodes);
FABSEQ_INSTANTIATE_STRUCT(ElasticModel);

}  // namespace fabseq
