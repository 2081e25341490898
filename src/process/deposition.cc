// SPDX-License-Identifier: MIT
#include "fabseq/process/deposition.h"

namespace fabseq {

template <int Dim>
Deposition<Dim>::Deposition(const ElasticModel<Dim>& model) : model_(model), halo_(model.part.grid(), 1) {}

template <int Dim>
typename Deposition<Dim>::Missing Deposition<Dim>::missing(const std::vector<double>& stage) const {
  std::vector<double> owned(static_cast<std::size_t>(model_.part.grid().owned_elements().count()), 1.0);
  for (std::size_t k = 0; k < model_.elements.size(); ++k) {
    const int number = model_.part_element[k];
    const double density = number >= 0 ? model_.part.part_density()[number] : 1.0;
    owned[model_.elements[k]] = 1.0 - model_.stage_density(stage, k) / density;
  }
  return halo_.gather(owned);
}

template <int Dim>
double Deposition<Dim>::product(const Missing& missing, const Index<Dim>& node,
                                const Index<Dim>* excluded) const {
  double result = 1.0;
  for (int number = 0; number < 1 << Dim && result != 0.0; ++number) {
    const Index<Dim> element = stepped<Dim>(node, number, -1);
    if (!halo_.box().contains(element) || (excluded != nullptr && element == *excluded)) continue;
    result *= missing[halo_.box().offset(element)];
  }
  return result;
}

template <int Dim>
LaneVector Deposition<Dim>::weights(const LayerDensities& densities, int first, int lanes) const {
  const auto& owned = model_.part.grid().owned_nodes();
  LaneVector result(static_cast<int>(model_.nodes.size()), 1, lanes);
  for (int lane = 0; lane < lanes; ++lane) {
    const Missing missing = this->missing(densities.stage[first + lane]);
    for (std::size_t k = 0; k < model_.nodes.size(); ++k)
      result(k, lane) = 1.0 - product(missing, owned.index(model_.nodes[k]));
  }
  return result;
}

template <int Dim>
void Deposition<Dim>::add_derivatives(const std::vector<Missing>& missing, int first,
                                      const LaneVector& d_weights, DensityDerivatives& derivatives) const {
  const Part<Dim>& part = model_.part;
  const Grid<Dim>& grid = part.grid();
  std::vector<double> owned(static_cast<std::size_t>(grid.owned_nodes().count()), 0.0);
  std::vector<double> of_nodes(static_cast<std::size_t>(grid.ghosted_nodes().count()));
  for (int lane = 0; lane < d_weights.lanes; ++lane) {
    for (std::size_t k = 0; k < model_.nodes.size(); ++k) owned[model_.nodes[k]] = d_weights(k, lane);
    grid.exchange(1).to_ghosted(owned, of_nodes);
    auto& d_stage = DensityDerivatives::touch(derivatives.stage[first + lane], part.elements().size());
    for (std::size_t e = 0; e < d_stage.size(); ++e) {
      const Index<Dim> element = grid.owned_elements().index(part.elements()[e]);
      double total = 0.0;
      for (int corner = 0; corner < 1 << Dim; ++corner) {
        const Index<Dim> node = stepped<Dim>(element, corner, 1);
        // Few nodes are measured, as a rule, and the product is dear.
        const double own = of_nodes[grid.ghosted_nodes().offset(node)];
        if (own != 0.0) total += own * product(missing[lane], node, &element);
      }
      d_stage[e] += total / part.part_density()[e];
    }
  }
}

FABSEQ_INSTANTIATE_CLASS(Deposition);

}  // namespace fabseq
