// SPDX-License-Identifier: MIT
#include "fabseq/thermal/thermal_model.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/corner_means.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

namespace {

/// Offsets in Grid::owned_elements() of the elements of part and substrate, ascending.
template <int Dim>
std::vector<int> solid_elements(const Part<Dim>& part) {
  const std::vector<double> solid = part.solid();
  std::vector<int> result;
  for (std::size_t e = 0; e < solid.size(); ++e)
    if (solid[e] > 0.0) result.push_back(static_cast<int>(e));
  return result;
}

template <int Dim>
std::vector<int> first_corners(const Grid<Dim>& grid, const std::vector<int>& elements) {
  std::vector<int> result;
  result.reserve(elements.size());
  for (const int element : elements)
    result.push_back(grid.first_corner(grid.owned_elements().index(element)));
  return result;
}

}  // namespace

std::vector<double> picked(std::span<const double> field, std::span<const int> nodes) {
  std::vector<double> result;
  result.reserve(nodes.size());
  for (const int node : nodes) result.push_back(field[node]);
  return result;
}

std::vector<double> spread_out(std::span<const double> values, std::span<const int> nodes,
                               std::size_t count) {
  std::vector<double> result(count, 0.0);
  for (std::size_t i = 0; i < nodes.size(); ++i) result[nodes[i]] = values[i];
  return result;
}

template <int Dim>
ThermalModel<Dim>::ThermalModel(const Part<Dim>& part_, const ThermalProperties& properties_)
    : ThermalModel(part_, properties_, solid_elements(part_)) {}

template <int Dim>
ThermalModel<Dim>::ThermalModel(const Part<Dim>& part_, const ThermalProperties& properties_,
                                const std::vector<int>& elements)
    : part(part_),
      properties(properties_),
      element(part.grid().spacing(), part.grid().domain().thickness, 0.0),
      domain{1, first_corners(part.grid(), elements), {}},
      film(part, elements, domain.first_corners) {
  const Grid<Dim>& grid = part.grid();
  for (std::size_t e = 0, next = 0; e < elements.size(); ++e) {
    if (next == part.elements().size() || part.elements()[next] != elements[e]) continue;
    part_position.push_back(static_cast<int>(e));
    ++next;
  }
  const std::vector<char> touched = nodes_of_elements(grid, elements);
  domain.fixed.resize(touched.size());
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    domain.fixed[offset] = part.on_plate(node) ? 1 : 0;
    if (touched[offset] == 0) return;
    nodes.push_back(static_cast<int>(offset));
    if (part.on_plate(node)) held_.push_back(static_cast<int>(offset));
  });
}

template <int Dim>
void ThermalModel<Dim>::hold(std::span<double> theta) const {
  for (const int node : held_) theta[node] = properties.plate_excess();
}

template <int Dim>
double ThermalModel<Dim>::mass(const LayerDensities& densities, int layer) const {
  const std::vector<double>& density = densities.layer[layer];
  const double elements = sum(part.grid().comm(), std::accumulate(density.begin(), density.end(), 0.0));
  return properties.mass_density * part.grid().element_volume() * elements;
}

/// Sums up at the owners of the nodes.
template <int Dim>
std::vector<double> ThermalModel<Dim>::sum_of(std::span<const double> ghosted) const {
  std::vector<double> result(domain.fixed.size());
  part.grid().exchange(1).add_to_owned(ghosted, result);
  return result;
}

template <int Dim>
std::vector<double> ThermalModel<Dim>::lumped(std::span<const int> corners,
                                              std::span<const double> of_elements, double factor) const {
  return spread_to_corners(part.grid(), corners, of_elements, factor);
}

template <int Dim>
std::vector<double> ThermalModel<Dim>::capacity_of(std::span<const double> share) const {
  return lumped(domain.first_corners, share, properties.capacity * part.grid().element_volume());
}

template <int Dim>
std::vector<double> ThermalModel<Dim>::film_of(std::span<const double> standing) const {
  std::vector<double> ghosted(static_cast<std::size_t>(part.grid().ghosted_nodes().count()), 0.0);
  film.add_film(standing, properties.film, ghosted);
  return sum_of(ghosted);
}

template <int Dim>
std::vector<double> ThermalModel<Dim>::conducted(std::span<const double> share,
                                                 std::span<const double> potential) const {
  const Grid<Dim>& grid = part.grid();
  constexpr int corners = corner_count<Dim>;
  const std::vector<double> values = grid.exchange(1).ghosted(potential);
  std::vector<double> flow(values.size(), 0.0);
  const auto& matrix = element.conductivity();
  for (std::size_t e = 0; e < share.size(); ++e) {
    if (share[e] == 0.0) continue;
    std::array<double, corners> of_element{};
    for (int j = 0; j < corners; ++j) {
      const double value =
          properties.conductivity * share[e] * values[domain.first_corners[e] + grid.corner_offsets()[j]];
      for (int i = 0; i < corners; ++i) of_element[i] += matrix[i * corners + j] * value;
    }
    for (int i = 0; i < corners; ++i)
      flow[domain.first_corners[e] + grid.corner_offsets()[i]] += of_element[i];
  }
  return sum_of(flow);
}

template <int Dim>
ThermalLayer ThermalModel<Dim>::layer(const LayerDensities& densities, int number,
                                      std::span<const double> region) const {
  ThermalLayer result;
  result.mass = mass(densities, number);
  result.share.assign(domain.first_corners.size(), 1.0);
  std::vector<double> stage = densities.stage[number], new_material = densities.layer[number];
  for (std::size_t e = 0; e < part_position.size(); ++e) {
    const double in_region = region.empty() ? 1.0 : region[part.elements()[e]];
    stage[e] *= in_region;
    new_material[e] *= in_region;
    result.share[part_position[e]] = in_region * (least_share + (1.0 - least_share) * stage[e]);
  }
  result.capacity = capacity_of(result.share);
  if (properties.film > 0.0) {
    result.standing = film.standing(stage);
    result.film = film_of(result.standing);
  } else {
    result.film.assign(domain.fixed.size(), 0.0);
  }
  result.heat = lumped(part.first_corners(), new_material, properties.heat * part.grid().element_volume());
  return result;
}

template <int Dim>
std::vector<double> ThermalModel<Dim>::first_capacity() const {
  std::vector<double> share(domain.first_corners.size(), 1.0);
  for (const int position : part_position) share[position] = least_share;
  return capacity_of(share);
}

template <int Dim>
std::vector<double> ThermalModel<Dim>::start() const {
  std::vector<double> result(domain.fixed.size(), 0.0);
  for (std::size_t node = 0; node < result.size(); ++node)
    if (part.substrate().nodes()[node] != 0) result[node] = properties.plate_excess();
  hold(result);
  return result;
}

/// A layer of negative mass, which ends before it begins, takes no time.
template <int Dim>
std::vector<ThermalStep> ThermalModel<Dim>::steps(double mass, double inner_pause, double last_pause) const {
  const double welding = std::max(mass, 0.0) / properties.rate + (properties.passes - 1) * inner_pause;
  std::vector<ThermalStep> result(properties.welding_steps, {welding / properties.welding_steps, true});
  if (last_pause > 0.0)
    result.insert(result.end(), properties.pause_steps, {last_pause / properties.pause_steps, false});
  return result;
}

template <int Dim>
std::vector<double> ThermalModel<Dim>::weights(const std::vector<double>& layer_density) {
  std::vector<double> result = layer_density;
  for (double& weight : result) weight += layer_density_floor;
  return result;
}

template <int Dim>
double ThermalModel<Dim>::interpass(const std::vector<double>& layer_density,
                                    std::span<const double> theta) const {
  const std::vector<double> weight = weights(layer_density),
                            mean = corner_means(part.grid(), part.first_corners(), theta);
  std::array<double, 2> sums{std::inner_product(weight.begin(), weight.end(), mean.begin(), 0.0),
                             std::accumulate(weight.begin(), weight.end(), 0.0)};
  sum_in_place(part.grid().comm(), std::span<double>(sums));
  return sums[0] / sums[1];
}

FABSEQ_INSTANTIATE_STRUCT(ThermalModel);

}  // namespace fabseq
