// SPDX-License-Identifier: MIT
#include "multigrid/lane_layout.h"

#include "fabseq/base/mpi.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Copies values of `count` unknowns from `from_width` lanes each to `to_width`, as many as both have.
void copy_lanes(const double* from, int from_width, double* to, int to_width, std::int64_t count) {
  if (from_width == to_width) {
    std::copy_n(from, count * from_width, to);
    return;
  }
  const int lanes = std::min(from_width, to_width);
  for (std::int64_t i = 0; i < count; ++i) std::copy_n(from + i * from_width, lanes, to + i * to_width);
}

}  // namespace

template <int Dim>
LaneLayout<Dim>::LaneLayout(const Grid<Dim>& grid, const LaneLevel<Dim>& level, int components)
    : grid_(grid),
      components_(components),
      alone_(size_of(grid.comm()) == 1),
      mesh_nodes_(static_cast<std::size_t>(level.mesh.nodes())) {
  auto range = level.counted.begin();
  for (const auto& run : level.mesh.node_runs()) {
    const std::int64_t place = grid.ghosted_nodes().offset(run.index), end = run.node + run.length;
    for (std::int64_t node = run.node; node < end;) {
      while (range != level.counted.end() && range->end <= node) ++range;
      const bool counted = range != level.counted.end() && range->begin <= node;
      std::int64_t next = end;
      if (range != level.counted.end()) next = std::min(end, counted ? range->end : range->begin);
      pieces_.push_back({node, place + node - run.node, next - node, counted});
      node = next;
    }
  }
}

template <int Dim>
void LaneLayout<Dim>::to_mesh(const LaneVector& owned, int width, LaneArray& mesh) const {
  const int lanes = owned.lanes;
  const double* from = owned.values.data();
  if (!alone_) {
    ghosted_.resize(static_cast<std::size_t>(grid_.ghosted_nodes().count()) * components_ * lanes);
    grid_.exchange(components_ * lanes).to_ghosted(owned.values, ghosted_);
    from = ghosted_.data();
  }
  const std::size_t size = mesh_nodes_ * components_ * width;
  if (lanes < width)
    mesh.assign(size, 0.0);
  else
    mesh.resize(size);
  for (const Piece& piece : pieces_)
    copy_lanes(from + piece.place * components_ * lanes, lanes, &mesh[piece.node * components_ * width],
               width, piece.length * components_);
}

template <int Dim>
void LaneLayout<Dim>::to_owned(const LaneArray& mesh, int width, LaneVector& owned) const {
  const int lanes = owned.lanes;
  const std::int64_t node_values = static_cast<std::int64_t>(components_) * lanes;
  if (!alone_) ghosted_.resize(static_cast<std::size_t>(grid_.ghosted_nodes().count() * node_values));
  std::vector<double>& values = alone_ ? owned.values : ghosted_;
  std::int64_t done = 0;
  for (const Piece& piece : pieces_) {
    if (!piece.counted) continue;
    const std::int64_t begin = piece.place * node_values;
    std::fill(values.begin() + done, values.begin() + begin, 0.0);
    copy_lanes(&mesh[piece.node * components_ * width], width, &values[begin], lanes,
               piece.length * components_);
    done = begin + piece.length * node_values;
  }
  std::fill(values.begin() + done, values.end(), 0.0);
  if (!alone_) grid_.exchange(components_ * lanes).add_to_owned(ghosted_, owned.values);
}

FABSEQ_INSTANTIATE_CLASS(LaneLayout);

}  // namespace fabseq
