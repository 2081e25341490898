// SPDX-License-Identifier: MIT
#include "fabseq/sequence/heat_chain_rule.h"

#include "fabseq/sequence/element_means.h"

namespace fabseq {

template <int Dim>
HeatChainRule<Dim>::HeatChainRule(const Part<Dim>& part, const ElementMatrices<Dim>& element)
    : part_(part), element_(element) {}

template <int Dim>
void HeatChainRule<Dim>::set_temperature(std::span<const double> temperature) {
  constexpr int count = corner_count<Dim>;
  const auto& offsets = part_.grid().corner_offsets();
  const auto& corners = part_.first_corners();
  flux_.resize(corners.size() * count);
  for (std::size_t e = 0; e < corners.size(); ++e)
    for (int i = 0; i < count; ++i) {
      double sum = 0.0;
      for (int j = 0; j < count; ++j)
        sum += element_.conductivity()[i * count + j] * temperature[corners[e] + offsets[j]];
      flux_[e * count + i] = sum;
    }
}

/// -dJ/dT: mean and gradient of the temperature enter the time with a minus.
template <int Dim>
LaneVector HeatChainRule<Dim>::loads(std::span<const TimeDerivatives> rows) const {
  return pull_back_means(part_, element_, rows);
}

template <int Dim>
std::vector<std::vector<double>> HeatChainRule<Dim>::gradients(const LaneVector& adjoints) const {
  const Grid<Dim>& grid = part_.grid();
  const auto& corners = part_.first_corners();
  const int lanes = adjoints.lanes;
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * lanes);
  grid.exchange(lanes).to_ghosted(adjoints.values, ghosted);
  std::vector<std::vector<double>> result(lanes, std::vector<double>(corners.size()));
  std::vector<double> sums(lanes);
  for (std::size_t e = 0; e < corners.size(); ++e) {
    std::fill(sums.begin(), sums.end(), 0.0);
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      const double flux = flux_[e * corner_count<Dim> + corner];
      const double* adjoint =
          &ghosted[static_cast<std::size_t>(corners[e] + grid.corner_offsets()[corner]) * lanes];
      for (int lane = 0; lane < lanes; ++lane) sums[lane] += flux * adjoint[lane];
    }
    for (int lane = 0; lane < lanes; ++lane) result[lane][e] = sums[lane];
  }
  return result;
}

FABSEQ_INSTANTIATE_CLASS(HeatChainRule);

}  // namespace fabseq
