// SPDX-License-Identifier: MIT
#include "fabseq/process/support_forces.h"

#include <array>

namespace fabseq {

template <int Dim>
SupportForces<Dim>::SupportForces(const ElasticModel<Dim>& model) : model_(model) {
  const Grid<Dim>& grid = model.part.grid();
  const std::vector<double> fixed(model.domain.fixed.begin(), model.domain.fixed.end());
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * Dim);
  grid.exchange(Dim).to_ghosted(fixed, ghosted);
  for (std::size_t e = 0; e < model.elements.size(); ++e)
    for (const int offset : grid.corner_offsets())
      if (ghosted[static_cast<std::size_t>(model.domain.first_corners[e] + offset) * Dim] != 0.0) {
        elements_.push_back(static_cast<int>(e));
        break;
      }
}

template <int Dim>
void SupportForces<Dim>::add_reactions(const LayerDensities& densities, const StrainField& strains,
                                       const StrainFactors<Dim>& factors, const BlockRegion& region,
                                       const LaneVector& increments, std::span<double> reactions) const {
  constexpr int unknowns = element_unknowns<Dim>;
  const Grid<Dim>& grid = model_.part.grid();
  const auto nodes = static_cast<std::size_t>(grid.ghosted_nodes().count());
  const int first = region.block.first, lanes = increments.lanes;
  std::vector<double> u(nodes * Dim * lanes), forces(nodes * Dim, 0.0), owned(reactions.size());
  grid.exchange(Dim * lanes).to_ghosted(increments.values, u);
  for (const int e : elements_) {
    if (!region.has(e)) continue;
    // One product for all layers: they share the element's matrix.
    std::array<double, unknowns> stretched{}, load{};
    const int part_element = model_.part_element[e];
    for (int lane = 0; lane < lanes; ++lane) {
      const double factor = model_.stiffness(model_.stage_density(densities.stage[first + lane], e));
      for (int i = 0; i < unknowns; ++i)
        stretched[i] += factor * u[(node(e, i) * Dim + i % Dim) * lanes + lane];
      const double density = part_element >= 0 ? densities.layer[first + lane][part_element] : 0.0;
      if (!(density > 0.0)) continue;
      const auto unit_load = model_.unit_load(strains, factors, part_element, first + lane);
      for (int i = 0; i < unknowns; ++i) load[i] += model_.load(density) * unit_load[i];
    }
    for (int i = 0; i < unknowns; ++i) {
      double force = -load[i];
      for (int j = 0; j < unknowns; ++j) force += model_.element.stiffness()[i * unknowns + j] * stretched[j];
      forces[node(e, i) * Dim + i % Dim] += force;
    }
  }
  grid.exchange(Dim).add_to_owned(forces, owned);
  // Elsewhere forces are left that are no reactions.
  for (std::size_t i = 0; i < owned.size(); ++i)
    if (model_.domain.fixed[i] != 0) reactions[i] += owned[i];
}

template <int Dim>
void SupportForces<Dim>::subtract_motion(const LayerDensities& densities, const BlockRegion& region,
                                         std::span<const double> motion, LaneVector& loads) const {
  constexpr int unknowns = element_unknowns<Dim>;
  const Grid<Dim>& grid = model_.part.grid();
  const auto nodes = static_cast<std::size_t>(grid.ghosted_nodes().count());
  const int first = region.block.first, lanes = loads.lanes;
  std::vector<double> at_supports(motion.begin(), motion.end());
  for (std::size_t i = 0; i < at_supports.size(); ++i)
    if (model_.domain.fixed[i] == 0) at_supports[i] = 0.0;
  std::vector<double> w(nodes * Dim), forces(nodes * Dim * lanes, 0.0), owned(loads.values.size());
  grid.exchange(Dim).to_ghosted(at_supports, w);
  for (const int e : elements_)
    for (int i = 0; region.has(e) && i < unknowns; ++i) {
      double force = 0.0;
      for (int j = 0; j < unknowns; ++j)
        force += model_.element.stiffness()[i * unknowns + j] * w[node(e, j) * Dim + j % Dim];
      double* of_lanes = &forces[(node(e, i) * Dim + i % Dim) * lanes];
      for (int lane = 0; lane < lanes; ++lane)
        of_lanes[lane] += model_.stiffness(model_.stage_density(densities.stage[first + lane], e)) * force;
    }
  grid.exchange(Dim * lanes).add_to_owned(forces, owned);
  for (std::size_t i = 0; i < owned.size(); ++i) loads.values[i] -= owned[i];
}

template <int Dim>
void SupportForces<Dim>::add_motion(std::span<const double> motion, LaneVector& solutions) const {
  for (std::size_t i = 0; i < motion.size(); ++i)
    for (int lane = 0; model_.domain.fixed[i] != 0 && lane < solutions.lanes; ++lane)
      solutions(i, lane) += motion[i];
}

FABSEQ_INSTANTIATE_CLASS(SupportForces);

}  // namespace fabseq
