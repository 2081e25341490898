// SPDX-License-Identifier: MIT
#include "process/plastic_fields.h"

#include <cstddef>

namespace fabseq {

namespace {

constexpr int components = ElementModes::components;

}  // namespace

PlasticFields::PlasticFields(const ElasticModel<3>& model)
    : model_(model), modes_(model.element, model.part.grid().spacing()) {}

void PlasticFields::set_modes(const LaneVector& displacement, std::vector<double>& modes) const {
  const Grid<3>& grid = model_.part.grid();
  const int lanes = displacement.lanes;
  const std::vector<double> ghosted = grid.exchange(3 * lanes).ghosted(displacement.values);
  modes.resize(model_.elements.size() * components * lanes);
  for_lane_chunks(lanes, [&]<int Width>(int first) {
    for (std::size_t e = 0; e < model_.elements.size(); ++e) {
      ElementModes::Nodal<Width> u;
      for (int corner = 0; corner < 8; ++corner) {
        const std::size_t node = model_.domain.first_corners[e] + grid.corner_offsets()[corner];
        for (int a = 0; a < 3; ++a)
          u[a][corner] = Lanes<Width>::load(&ghosted[(node * 3 + a) * lanes + first]);
      }
      const auto of_element = modes_.of<Width>(u);
      for (int c = 0; c < components; ++c) of_element[c].store(&modes[(e * components + c) * lanes + first]);
    }
  });
}

void PlasticFields::set_forces(std::span<const double> modes, int lanes, LaneVector& force) const {
  const Grid<3>& grid = model_.part.grid();
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * 3 * lanes, 0.0);
  for_lane_chunks(lanes, [&]<int Width>(int first) {
    for (std::size_t e = 0; e < model_.elements.size(); ++e) {
      ElementModes::Modes<Width> of_element;
      for (int c = 0; c < components; ++c)
        of_element[c] = Lanes<Width>::load(&modes[(e * components + c) * lanes + first]);
      const auto f = modes_.forces<Width>(of_element);
      for (int corner = 0; corner < 8; ++corner) {
        const std::size_t node = model_.domain.first_corners[e] + grid.corner_offsets()[corner];
        for (int a = 0; a < 3; ++a) {
          double* place = &ghosted[(node * 3 + a) * lanes + first];
          (Lanes<Width>::load(place) + f[a][corner]).store(place);
        }
      }
    }
  });
  resize(force, static_cast<int>(grid.owned_nodes().count()), 3, lanes);
  grid.exchange(3 * lanes).add_to_owned(ghosted, force.values);
}

}  // namespace fabseq
