// SPDX-License-Identifier: MIT
#include "fabseq/process/built_region.h"

#include "fabseq/base/mpi.h"
#include "fabseq/kernels/lane_vector.h"
#include "fabseq/part/pieces.h"

#include <algorithm>

namespace fabseq {

template <int Dim>
BuiltRegion<Dim>::BuiltRegion(const ElasticModel<Dim>& model)
    : model_(model), standing_(model.part, model.settings.least_standing()) {
  const Grid<Dim>& grid = model.part.grid();
  const std::vector<double> fixed(model.domain.fixed.begin(), model.domain.fixed.end());
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * Dim);
  grid.exchange(Dim).to_ghosted(fixed, ghosted);
  const auto face_is_held = [&](int first_corner, int face) {
    for (int corner = 0; corner < corner_count<Dim>; ++corner)
      if ((corner >> face / 2 & 1) == face % 2 &&
          ghosted[static_cast<std::size_t>(first_corner + grid.corner_offsets()[corner]) * Dim] == 0.0)
        return false;
    return true;
  };
  for (std::size_t e = 0; e < model.elements.size(); ++e)
    for (int face = 0; face < 2 * Dim; ++face)
      if (face_is_held(model.domain.first_corners[e], face)) {
        held_.push_back(model.elements[e]);
        break;
      }
}

template <int Dim>
BlockRegion BuiltRegion<Dim>::of(const LayerDensities& densities, const StepBlock& block,
                                 std::span<const BuildStep> steps) const {
  const std::vector<double> region = standing_.with_neighbors(densities, steps.back().layer);
  const auto count = static_cast<std::int64_t>(std::count(region.begin(), region.end(), 1.0));
  const auto all = static_cast<std::int64_t>(model_.elements.size());
  BlockRegion result{block, {steps.begin(), steps.end()}};
  if (sum(model_.part.grid().comm(), all - count) == 0 || !is_held(region)) return result;
  std::vector<int> inside;
  result.elements.reserve(model_.elements.size());
  for (const int element : model_.elements) {
    result.elements.push_back(region[element] > 0.0 ? 1 : 0);
    if (region[element] > 0.0) inside.push_back(element);
  }
  result.nodes = touched_nodes(model_.part.grid(), inside);
  return result;
}

template <int Dim>
std::vector<double> BuiltRegion<Dim>::standing_shares(const LayerDensities& densities) const {
  std::vector<double> result;
  for (int layer = 0; layer < densities.count(); ++layer) {
    if (layer % widest_block == 0) {
      const std::vector<double> field = standing_.of(densities, layer);
      result.push_back(static_cast<double>(std::count(field.begin(), field.end(), 1.0)));
    } else {
      result.push_back(result.back());
    }
  }
  result.push_back(static_cast<double>(model_.elements.size()));
  sum_in_place(model_.part.grid().comm(), result);
  const double all = result.back();
  result.pop_back();
  for (double& share : result) share /= all;
  return result;
}

/// Whether each piece has an element on a support.
template <int Dim>
bool BuiltRegion<Dim>::is_held(const std::vector<double>& region) const {
  const PieceMap<Dim> map = find_pieces<Dim>(model_.part.grid(), region, model_.part.plate());
  std::vector<double> held(map.pieces.size(), 0.0);
  for (const int element : held_)
    if (map.piece_of_element[element] >= 0) held[map.piece_of_element[element]] = 1.0;
  sum_in_place(model_.part.grid().comm(), held);
  return !held.empty() && std::ranges::all_of(held, [](double count) { return count > 0.0; });
}

FABSEQ_INSTANTIATE_CLASS(BuiltRegion);

}  // namespace fabseq
