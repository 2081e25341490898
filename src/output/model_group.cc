// SPDX-License-Identifier: MIT
#include "fabseq/output/model_group.h"

#include "fabseq/process/elastic_model.h"

#include <algorithm>
#include <iterator>
#include <vector>

namespace fabseq {

namespace {

/// Nodes of the model's elements that are held: offsets in Grid::owned_nodes().
template <int Dim>
std::vector<int> held_nodes_of(const ElasticModel<Dim>& elastic) {
  std::vector<int> result;
  std::copy_if(elastic.nodes.begin(), elastic.nodes.end(), std::back_inserter(result),
               [&](int node) { return elastic.supports.held[node] != 0; });
  return result;
}

}  // namespace

template <int Dim>
void write_model_group(Hdf5Writer& file, const Model<Dim>& model, const BuiltStrain& strain) {
  const Grid<Dim>& grid = model.grid;
  const ElasticModel<Dim> elastic(model.part, model.supports, model.settings.material,
                                  model.settings.process);
  // Config allows no names that HDF5 would take for groups.
  for (const auto& [name, set] : model.node_sets)
    file.template write_node_numbers<Dim>(grid, "model/node_sets/" + name, set.owned);
  file.template write_node_numbers<Dim>(grid, "model/supports", held_nodes_of(elastic));

  const std::vector<double> stiffness = elastic.finished_stiffness();
  std::vector<double> factor;
  for (const double density : model.part.part_density()) factor.push_back(elastic.strain_factor(density));
  const std::vector<int>& in_part = model.part.elements();
  FieldSet<Dim> fields{&grid, {}};
  fields.add_elements("model/stiffness", stiffness, 1, &elastic.elements);
  fields.add_elements("model/strain_factor", factor, 1, &in_part);
  if (strain.uniform) {
    file.write_array("model/strain", strain.values);
  } else {
    fields.add_elements("model/strain", strain.values, voigt_size<Dim>, &in_part);
    fields.fields.back().single_precision = true;  // or it takes most of the group
  }
  file.write_fields(fields);
  file.write_array("model/unbuilt_stiffness", std::vector<double>{elastic.stiffness(0.0)});
}

FABSEQ_INSTANTIATE_FUNCTION(write_model_group);

}  // namespace fabseq
