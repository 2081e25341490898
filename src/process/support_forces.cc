// SPDX-License-Identifier: MIT
#include "fabseq/process/support_forces.h"

#include "process/strained_elements.h"

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
std::vector<typename SupportForces<Dim>::ElementLoad> SupportForces<Dim>::summed_loads(
    const LayerDensities& densities, const StrainSource<Dim>& strains, const BlockRegion& region) const {
  std::vector<ElementLoad> result(elements_.size(), ElementLoad{});
  std::vector<int> of_part;                                     // part elements
  std::vector<std::size_t> place(model_.part_position.size());  // of part elements in `elements_`
  for (std::size_t k = 0; k < elements_.size(); ++k) {
    const int element = model_.part_element[elements_[k]];
    if (element < 0 || !region.has(elements_[k])) continue;
    of_part.push_back(element);
    place[element] = k;
  }
  for (int lane = 0; lane < region.block.lanes; ++lane) {
    const StrainedElements strained = strained_elements<Dim>(model_, strains, densities, region.steps[lane],
                                                             region.block.first + lane, of_part);
    for (std::size_t e = 0; e < strained.elements.size(); ++e) {
      const auto unit_load = model_.element.strain_load(strained.strain<Dim>(e));
      ElementLoad& load = result[place[strained.elements[e]]];
      for (std::size_t i = 0; i < load.size(); ++i) load[i] += strained.factors[e] * unit_load[i];
    }
  }
  return result;
}

template <int Dim>
void SupportForces<Dim>::add_reactions(const LayerDensities& densities, const StrainSource<Dim>& strains,
                                       const BlockRegion& region, const LaneVector& increments,
                                       std::span<double> reactions) const {
  constexpr int unknowns = element_unknowns<Dim>;
  const Grid<Dim>& grid = model_.part.grid();
  const auto nodes = static_cast<std::size_t>(grid.ghosted_nodes().count());
  const int lanes = increments.lanes;
  std::vector<double> u(nodes * Dim * lanes), forces(nodes * Dim, 0.0), owned(reactions.size());
  grid.exchange(Dim * lanes).to_ghosted(increments.values, u);
  const std::vector<ElementLoad> loads = summed_loads(densities, strains, region);
  for (std::size_t k = 0; k < elements_.size(); ++k) {
    const int e = elements_[k];
    if (!region.has(e)) continue;
    // One product for all steps: they share the element's matrix.
    std::array<double, unknowns> stretched{};
    for (int lane = 0; lane < lanes; ++lane) {
      const double factor = model_.stiffness(model_.stage_density(densities.stage[region.layer(lane)], e));
      for (int i = 0; i < unknowns; ++i)
        stretched[i] += factor * u[(node(e, i) * Dim + i % Dim) * lanes + lane];
    }
    for (int i = 0; i < unknowns; ++i) {
      double force = -loads[k][i];
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
  const int lanes = loads.lanes;
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
        of_lanes[lane] +=
            model_.stiffness(model_.stage_density(densities.stage[region.layer(lane)], e)) * force;
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
