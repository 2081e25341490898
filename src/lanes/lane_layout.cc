// SPDX-License-Identifier: MIT
#include "fabseq/lanes/lane_layout.h"

#include <algorithm>

namespace fabseq {

template <int Dim>
LaneLayout<Dim>::LaneLayout(const Grid<Dim>& grid, const LaneLevel<Dim>& level, int components)
    : grid_(grid), level_(level), components_(components) {
  for (const auto& run : level.mesh.node_runs())
    for (int i = 0; i < run.length; ++i) {
      Index<Dim> node = run.index;
      node[0] += i;
      places_.push_back(grid.ghosted_nodes().offset(node));
    }
}

template <int Dim>
void LaneLayout<Dim>::to_mesh(const LaneVector& owned, int width, LaneArray& mesh) const {
  const int lanes = owned.lanes;
  ghosted_.resize(static_cast<std::size_t>(grid_.ghosted_nodes().count()) * components_ * lanes);
  grid_.exchange(components_ * lanes).to_ghosted(owned.values, ghosted_);
  mesh.assign(places_.size() * components_ * width, 0.0);
  for (std::size_t node = 0; node < places_.size(); ++node)
    for (int a = 0; a < components_; ++a)
      std::copy_n(&ghosted_[(places_[node] * components_ + a) * lanes], lanes,
                  &mesh[(node * components_ + a) * width]);
}

template <int Dim>
void LaneLayout<Dim>::to_owned(const LaneArray& mesh, int width, LaneVector& owned) const {
  const int lanes = owned.lanes;
  ghosted_.assign(static_cast<std::size_t>(grid_.ghosted_nodes().count()) * components_ * lanes, 0.0);
  for (const auto& range : level_.counted)
    for (std::int64_t node = range.begin; node < range.end; ++node)
      for (int a = 0; a < components_; ++a)
        std::copy_n(&mesh[(node * components_ + a) * width], lanes,
                    &ghosted_[(places_[node] * components_ + a) * lanes]);
  grid_.exchange(components_ * lanes).add_to_owned(ghosted_, owned.values);
}

FABSEQ_INSTANTIATE_CLASS(LaneLayout);

}  // namespace fabseq
