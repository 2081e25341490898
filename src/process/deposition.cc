// SPDX-License-Identifier: MIT
#include "fabseq/process/deposition.h"

#include <algorithm>
#include <cstdint>

namespace fabseq {

namespace {

/// Returns the products of all factors but one each, without a division: some are 0.
template <std::size_t Count>
std::array<double, Count> products_of_others(const std::array<double, Count>& factors) {
  std::array<double, Count> result;
  double before = 1.0, behind = 1.0;
  for (std::size_t i = 0; i < Count; ++i) {
    result[i] = before;
    before *= factors[i];
  }
  for (std::size_t i = Count; i-- > 0;) {
    result[i] *= behind;
    behind *= factors[i];
  }
  return result;
}

}  // namespace

template <int Dim>
Deposition<Dim>::Deposition(const ElasticModel<Dim>& model)
    : model_(model), halo_(model.part.grid(), 1), part_element_(halo_.box().count() + 1, -1) {
  const Grid<Dim>& grid = model.part.grid();
  const auto outside = static_cast<int>(halo_.box().count());
  grid.ghosted_nodes().for_each([&](const Index<Dim>& node, std::int64_t) {
    Around& around = around_.emplace_back();
    for (int number = 0; number < corner_count<Dim>; ++number) {
      const Index<Dim> element = stepped<Dim>(node, number, -1);
      around[number] =
          halo_.box().contains(element) ? static_cast<int>(halo_.box().offset(element)) : outside;
    }
  });
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t) {
    ghosted_.push_back(static_cast<int>(grid.ghosted_nodes().offset(node)));
  });
  const std::vector<int>& elements = model.part.elements();
  for (std::size_t e = 0; e < elements.size(); ++e)
    part_element_[halo_.box().offset(grid.owned_elements().index(elements[e]))] = static_cast<int>(e);
}

template <int Dim>
typename Deposition<Dim>::Missing Deposition<Dim>::missing(const std::vector<double>& stage) const {
  std::vector<double> owned(static_cast<std::size_t>(model_.part.grid().owned_elements().count()), 1.0);
  for (std::size_t k = 0; k < model_.elements.size(); ++k) {
    const int number = model_.part_element[k];
    const double density = number >= 0 ? model_.part.part_density()[number] : 1.0;
    owned[model_.elements[k]] = 1.0 - model_.stage_density(stage, k) / density;
  }
  Missing result = halo_.gather(owned);
  result.push_back(1.0);
  return result;
}

template <int Dim>
std::vector<typename Deposition<Dim>::Missing> Deposition<Dim>::missing(
    const LayerDensities& densities, std::span<const BuildStep> steps) const {
  std::vector<Missing> result;
  for (const BuildStep& step : steps) result.push_back(missing(densities.stage[step.layer]));
  return result;
}

template <int Dim>
LaneVector Deposition<Dim>::weights(const LayerDensities& densities, std::span<const BuildStep> steps,
                                    std::span<const int> nodes) const {
  LaneVector result(static_cast<int>(nodes.size()), 1, static_cast<int>(steps.size()));
  for (int lane = 0; lane < result.lanes; ++lane) {
    const Missing missing = this->missing(densities.stage[steps[lane].layer]);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      double product = 1.0;
      for (const int element : around_[ghosted_[nodes[k]]]) product *= missing[element];
      result(k, lane) = 1.0 - product;
    }
  }
  return result;
}

template <int Dim>
void Deposition<Dim>::add_derivatives(const std::vector<Missing>& missing, std::span<const BuildStep> steps,
                                      std::span<const int> nodes, const LaneVector& d_weights,
                                      DensityDerivatives& derivatives) const {
  const Part<Dim>& part = model_.part;
  const Grid<Dim>& grid = part.grid();
  std::vector<double> owned(static_cast<std::size_t>(grid.owned_nodes().count()), 0.0);
  std::vector<double> of_nodes(static_cast<std::size_t>(grid.ghosted_nodes().count()));
  for (int lane = 0; lane < d_weights.lanes; ++lane) {
    for (std::size_t k = 0; k < nodes.size(); ++k) owned[nodes[k]] = d_weights(k, lane);
    grid.exchange(1).to_ghosted(owned, of_nodes);
    auto& d_stage =
        DensityDerivatives::zeros_if_empty(derivatives.stage[steps[lane].layer], part.elements().size());
    for (std::size_t node = 0; node < of_nodes.size(); ++node)
      if (of_nodes[node] != 0.0) add_derivatives_at(around_[node], missing[lane], of_nodes[node], d_stage);
  }
}

template <int Dim>
void Deposition<Dim>::add_derivatives_at(const Around& around, const Missing& missing, double d_weight,
                                         std::vector<double>& d_stage) const {
  std::array<double, corner_count<Dim>> factors;
  for (int number = 0; number < corner_count<Dim>; ++number) factors[number] = missing[around[number]];
  if (std::ranges::count(factors, 0.0) > 1) return;
  const auto others = products_of_others(factors);
  for (int number = 0; number < corner_count<Dim>; ++number) {
    const int e = part_element_[around[number]];
    if (e >= 0) d_stage[e] += d_weight * others[number] / model_.part.part_density()[e];
  }
}

FABSEQ_INSTANTIATE_CLASS(Deposition);

}  // namespace fabseq
