// SPDX-License-Identifier: MIT
#include "fabseq/process/adjoint_loads.h"

#include "fabseq/base/mpi.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Steps whose load has less than this share of the largest are left out.
constexpr double least_share = 1e-10;

}  // namespace

void set_adjoint_load(const ProcessAdjoint& functional, const ProcessResult& result, std::size_t block,
                      LaneVector& load) {
  const LaneVector* own = functional.increments.empty() ? nullptr : &functional.increments[block];
  const LaneVector* weights = result.weights.empty() ? nullptr : &result.weights[block];
  std::fill(load.values.begin(), load.values.end(), 0.0);
  for (std::size_t i = 0; i < result.nodes[block].size() * load.components; ++i) {
    const std::size_t to = result.in_field(block, i, load.components);
    const double common = functional.displacement.empty() ? 0.0 : functional.displacement[to];
    for (int lane = 0; lane < load.lanes; ++lane) {
      const double derivative = common + (own != nullptr ? (*own)(i, lane) : 0.0);
      load(to, lane) = -derivative * (weights != nullptr ? (*weights)(i / load.components, lane) : 1.0);
    }
  }
}

template <int Dim>
void AdjointLoads<Dim>::update(const LayerDensities& densities, const ProcessResult& result,
                               std::span<const ProcessAdjoint> functionals) {
  const std::size_t steps = result.steps.size();
  counts_.assign(functionals.size(), std::vector<char>(steps, 1));
  const auto of_release = [](const ProcessAdjoint& functional) { return !functional.release.empty(); };
  if (model_.settings.deposition == DepositionModel::follow ||
      std::all_of(functionals.begin(), functionals.end(), of_release))
    return;
  std::vector<double> squares(functionals.size() * steps, 0.0);
  const LayerGroups& groups = systems_.groups();
  groups.run([&] {
    for (std::size_t number = 0; number < result.blocks.size(); ++number) {
      const StepBlock& block = result.blocks[number];
      const BlockRegion& region = systems_.blocks()[number];
      const LaneVector stiffness = systems_.elements().at_nodes(
          systems_.elements().stiffness(densities, {region.block, region.steps}), block.lanes);
      LaneVector load(stiffness.nodes, Dim, block.lanes);
      for (std::size_t k = 0; k < functionals.size(); ++k) {
        if (of_release(functionals[k])) continue;
        set_adjoint_load(functionals[k], result, number, load);
        add_squares(block, load, stiffness, std::span(squares).subspan(k * steps, steps));
      }
    }
  });
  sum_in_place(groups.world(), squares);
  for (std::size_t k = 0; k < functionals.size(); ++k) {
    if (of_release(functionals[k])) continue;
    const auto first = squares.begin() + static_cast<std::ptrdiff_t>(k * steps);
    const double least =
        least_share * least_share * *std::max_element(first, first + static_cast<std::ptrdiff_t>(steps));
    for (std::size_t j = 0; j < steps; ++j) counts_[k][j] = squares[k * steps + j] > least ? 1 : 0;
  }
}

template <int Dim>
bool AdjointLoads<Dim>::any(std::size_t functional, const StepBlock& block) const {
  const auto first = counts_[functional].begin() + block.first;
  return std::any_of(first, first + block.lanes, [](char counts) { return counts != 0; });
}

template <int Dim>
void AdjointLoads<Dim>::set(const ProcessAdjoint& functional, std::size_t number, const ProcessResult& result,
                            std::size_t block, LaneVector& load) const {
  set_adjoint_load(functional, result, block, load);
  for (int lane = 0; lane < load.lanes; ++lane)
    for (std::size_t i = 0; counts_[number][result.blocks[block].first + lane] == 0 && i < load.unknowns();
         ++i)
      load(i, lane) = 0.0;
}

template <int Dim>
void AdjointLoads<Dim>::add_squares(const StepBlock& block, const LaneVector& load,
                                    const LaneVector& stiffness, std::span<double> squares) const {
  for (std::size_t i = 0; i < load.unknowns(); ++i)
    for (int lane = 0; model_.domain.fixed[i] == 0 && lane < block.lanes; ++lane)
      if (load(i, lane) != 0.0)
        squares[block.first + lane] += load(i, lane) * load(i, lane) / stiffness(i / Dim, lane);
}

FABSEQ_INSTANTIATE_CLASS(AdjointLoads);

}  // namespace fabseq
