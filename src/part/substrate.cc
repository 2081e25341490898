// SPDX-License-Identifier: MIT
#include "fabseq/part/substrate.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"

#include <algorithm>
#include <limits>

namespace fabseq {

template <int Dim>
std::vector<char> nodes_of_elements(const Grid<Dim>& grid, const std::vector<int>& elements) {
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()), 0.0);
  for (const int element : elements) {
    const int first = grid.first_corner(grid.owned_elements().index(element));
    for (const int corner : grid.corner_offsets()) ghosted[first + corner] = 1.0;
  }
  std::vector<double> owned(static_cast<std::size_t>(grid.owned_nodes().count()));
  grid.exchange(1).add_to_owned(ghosted, owned);
  std::vector<char> nodes(owned.size());
  std::transform(owned.begin(), owned.end(), nodes.begin(),
                 [](double value) { return static_cast<char>(value > 0.0); });
  return nodes;
}

template <int Dim>
Substrate<Dim>::Substrate(const Grid<Dim>& grid, const std::optional<Shape>& shape)
    : grid_(grid),
      elements_(static_cast<std::size_t>(grid.owned_elements().count()), 0),
      nodes_(static_cast<std::size_t>(grid.owned_nodes().count()), 0) {
  if (!shape) return;
  const double tolerance = shape_tolerance * grid.smallest_spacing();
  std::vector<int> chosen;
  grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t offset) {
    if (!shape->contains(grid.element_center(element), tolerance)) return;
    elements_[offset] = 1;
    chosen.push_back(static_cast<int>(offset));
  });
  count_ = sum(grid.comm(), static_cast<std::int64_t>(chosen.size()));
  if (count_ == 0)
    throw InputError(
        "/substrate: no element's centre in the domain lies inside the shape; needs at least one");
  nodes_ = nodes_of_elements(grid, chosen);
}

template <int Dim>
std::vector<char> Substrate<Dim>::nodes_towards(const BuildPlate& plate) const {
  const int away = plate.upper ? -1 : 1;
  int lowest = std::numeric_limits<int>::max();
  grid_.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    if (nodes_[offset] != 0) lowest = std::min(lowest, away * node[plate.axis]);
  });
  lowest = static_cast<int>(min(grid_.comm(), static_cast<std::int64_t>(lowest)));
  std::vector<char> result(nodes_.size(), 0);
  grid_.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    result[offset] = nodes_[offset] != 0 && away * node[plate.axis] == lowest ? 1 : 0;
  });
  return result;
}

template <int Dim>
std::vector<double> Substrate<Dim>::contact_distance() const {
  std::vector<double> distance(elements_.size(), std::numeric_limits<double>::infinity());
  if (count_ == 0) return distance;
  const ElementHalo<Dim> halo(grid_, 1);
  const std::vector<double> there = halo.gather(std::vector<double>(elements_.begin(), elements_.end()));
  grid_.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t offset) {
    for (int face = 0; face < 2 * Dim; ++face) {
      Index<Dim> neighbor = element;
      neighbor[face / 2] += face % 2 == 0 ? -1 : 1;
      if (halo.box().contains(neighbor) && there[halo.box().offset(neighbor)] > 0.0)
        distance[offset] = std::min(distance[offset], 0.5 * grid_.spacing()[face / 2]);
    }
  });
  return distance;
}

FABSEQ_INSTANTIATE_CLASS(Substrate);
FABSEQ_INSTANTIATE_FUNCTION(nodes_of_elements);

}  // namespace fabseq
