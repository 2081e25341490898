#include "fabseq/solve/lane_layout.h"

#include <algorithm>
#include <limits>

namespace fabseq {

template <int Dim>
LaneLayout<Dim>::LaneLayout(const Grid<Dim>& grid, const LaneLevel<Dim>& level, int components)
    : grid_(grid), level_(level), components_(components), counted_(level.mesh.nodes(), 0) {
  for (const auto& run : level.mesh.node_runs())
    for (int i = 0; i < run.length; ++i) {
      Index<Dim> node = run.index;
      node[0] += i;
      places_.push_back(grid.ghosted_nodes().offset(node));
    }
  for (const auto& range : level.counted)
    std::fill(counted_.begin() + range.begin, counted_.begin() + range.end, 1);
}

template <int Dim>
int LaneLayout<Dim>::lanes_at_once(int lanes) const {
  const std::int64_t values = grid_.all_nodes().count() * components_ * lanes;
  return values < std::numeric_limits<PetscInt>::max() ? lanes : 1;
}

template <int Dim>
void LaneLayout<Dim>::to_mesh(const LaneVector& owned, int width, LaneArray& mesh) const {
  mesh.assign(places_.size() * components_ * width, 0.0);
  const int together = lanes_at_once(owned.lanes);
  std::vector<double> part(owned.unknowns() * together);
  std::vector<double> ghosted(static_cast<std::size_t>(grid_.ghosted_nodes().count()) * components_ *
                              together);
  for (int first = 0; first < owned.lanes; first += together) {
    for (std::size_t i = 0; i < owned.unknowns(); ++i)
      std::copy_n(&owned.values[i * owned.lanes + first], together, &part[i * together]);
    grid_.exchange(components_ * together).to_ghosted(part, ghosted);
    for (std::size_t node = 0; node < places_.size(); ++node)
      for (int a = 0; a < components_; ++a)
        std::copy_n(&ghosted[(places_[node] * components_ + a) * together], together,
                    &mesh[(node * components_ + a) * width + first]);
  }
}

template <int Dim>
void LaneLayout<Dim>::to_owned(const LaneArray& mesh, int width, LaneVector& owned) const {
  const int together = lanes_at_once(owned.lanes);
  std::vector<double> part(owned.unknowns() * together);
  std::vector<double> ghosted(static_cast<std::size_t>(grid_.ghosted_nodes().count()) * components_ *
                              together);
  for (int first = 0; first < owned.lanes; first += together) {
    std::fill(ghosted.begin(), ghosted.end(), 0.0);
    for (std::size_t node = 0; node < places_.size(); ++node)
      for (int a = 0; counted_[node] != 0 && a < components_; ++a)
        std::copy_n(&mesh[(node * components_ + a) * width + first], together,
                    &ghosted[(places_[node] * components_ + a) * together]);
    grid_.exchange(components_ * together).add_to_owned(ghosted, part);
    for (std::size_t i = 0; i < owned.unknowns(); ++i)
      std::copy_n(&part[i * together], together, &owned.values[i * owned.lanes + first]);
  }
}

template class LaneLayout<2>;
template class LaneLayout<3>;

}  // namespace fabseq
