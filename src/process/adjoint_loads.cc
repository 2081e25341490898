// SPDX-License-Identifier: MIT
#include "fabseq/process/adjoint_loads.h"

#include "fabseq/base/mpi.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Layers whose load has less than this share of the largest are left out.
constexpr double least_share = 1e-10;

void set_full_load(const ProcessAdjoint& functional, const ProcessResult& result, std::size_t block,
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

}  // namespace

template <int Dim>
void AdjointLoads<Dim>::update(const LayerDensities& densities, const ProcessResult& result,
                               std::span<const ProcessAdjoint> functionals) {
  const auto layers = static_cast<std::size_t>(densities.count());
  counts_.assign(functionals.size(), std::vector<char>(layers, 1));
  const auto of_release = [](const ProcessAdjoint& functional) { return !functional.release.empty(); };
  if (model_.settings.deposition == DepositionModel::follow ||
      std::all_of(functionals.begin(), functionals.end(), of_release))
    return;
  std::vector<double> squares(functionals.size() * layers, 0.0);
  groups_.run([&] {
    for (std::size_t number = 0; number < result.blocks.size(); ++number) {
      const LayerBlock& block = result.blocks[number];
      const LaneVector stiffness = nodal_stiffness(densities, block);
      LaneVector load(stiffness.nodes, Dim, block.lanes);
      for (std::size_t k = 0; k < functionals.size(); ++k) {
        if (of_release(functionals[k])) continue;
        set_full_load(functionals[k], result, number, load);
        add_squares(block, load, stiffness, std::span(squares).subspan(k * layers, layers));
      }
    }
  });
  sum_in_place(groups_.world(), squares);
  for (std::size_t k = 0; k < functionals.size(); ++k) {
    if (of_release(functionals[k])) continue;
    const auto first = squares.begin() + static_cast<std::ptrdiff_t>(k * layers);
    const double least = least_share * least_share * *std::max_element(first, first + densities.count());
    for (std::size_t j = 0; j < layers; ++j) counts_[k][j] = squares[k * layers + j] > least ? 1 : 0;
  }
}

template <int Dim>
bool AdjointLoads<Dim>::any(std::size_t functional, const LayerBlock& block) const {
  const auto first = counts_[functional].begin() + block.first;
  return std::any_of(first, first + block.lanes, [](char counts) { return counts != 0; });
}

template <int Dim>
void AdjointLoads<Dim>::set(const ProcessAdjoint& functional, std::size_t number, const ProcessResult& result,
                            std::size_t block, LaneVector& load) const {
  set_full_load(functional, result, block, load);
  for (int lane = 0; lane < load.lanes; ++lane)
    for (std::size_t i = 0; counts_[number][result.blocks[block].first + lane] == 0 && i < load.unknowns();
         ++i)
      load(i, lane) = 0.0;
}

template <int Dim>
void AdjointLoads<Dim>::add_squares(const LayerBlock& block, const LaneVector& load,
                                    const LaneVector& stiffness, std::span<double> squares) const {
  for (std::size_t i = 0; i < load.unknowns(); ++i)
    for (int lane = 0; model_.domain.fixed[i] == 0 && lane < block.lanes; ++lane)
      if (load(i, lane) != 0.0)
        squares[block.first + lane] += load(i, lane) * load(i, lane) / stiffness(i / Dim, lane);
}

template <int Dim>
LaneVector AdjointLoads<Dim>::nodal_stiffness(const LayerDensities& densities,
                                              const LayerBlock& block) const {
  const Grid<Dim>& grid = model_.part.grid();
  const std::vector<double> of_elements = elements_.stiffness(densities, {block, {}, {}});
  std::vector<double> of_nodes(static_cast<std::size_t>(grid.ghosted_nodes().count()) * block.lanes, 0.0);
  for (std::size_t e = 0; e < model_.elements.size(); ++e)
    for (const int offset : grid.corner_offsets()) {
      const std::size_t node = model_.domain.first_corners[e] + offset;
      for (int lane = 0; lane < block.lanes; ++lane)
        of_nodes[node * block.lanes + lane] += of_elements[e * block.lanes + lane];
    }
  LaneVector result(static_cast<int>(grid.owned_nodes().count()), 1, block.lanes);
  grid.exchange(block.lanes).add_to_owned(of_nodes, result.values);
  return result;
}

FABSEQ_INSTANTIATE_CLASS(AdjointLoads);

}  // namespace fabseq
