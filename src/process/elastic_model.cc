#include "fabseq/process/elastic_model.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

template <int Dim>
ElasticModel<Dim>::ElasticModel(const Part<Dim>& part_, const MaterialSettings& material_,
                                const ProcessSettings& settings_)
    : part(part_),
      material(material_),
      settings(settings_),
      element(part.grid().spacing(), part.grid().domain().thickness, material.poisson),
      strain_load(element.strain_load(material.inherent_strain)) {
  const Grid<Dim>& grid = part.grid();
  domain.components = Dim;
  if (settings.void_model == VoidModel::quiet) {
    grid.owned_elements().for_each([&](const Index<Dim>& index, std::int64_t) {
      domain.first_corners.push_back(grid.first_corner(index));
    });
    part_position = part.elements();
  } else {
    domain.first_corners = part.first_corners();
    part_position.resize(part.elements().size());
    std::iota(part_position.begin(), part_position.end(), 0);
  }
  domain.fixed.resize(static_cast<std::size_t>(grid.owned_nodes().count()) * Dim);
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    std::fill_n(domain.fixed.begin() + offset * Dim, Dim, part.on_plate(node) ? 1 : 0);
  });
}

template struct ElasticModel<2>;
template struct ElasticModel<3>;

}  // namespace fabseq
