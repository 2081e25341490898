// SPDX-License-Identifier: MIT
#include "fabseq/part/supports.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/part/rigid_motions.h"

#include <algorithm>
#include <iterator>

namespace fabseq {

namespace {

template <int Dim>
std::vector<char> held_nodes(const Part<Dim>& part, const PartDescription& description) {
  const Grid<Dim>& grid = part.grid();
  if (!description.clamps && part.substrate().count() > 0)
    return part.substrate().nodes_towards(part.plate());
  std::vector<char> held(static_cast<std::size_t>(grid.owned_nodes().count()), 0);
  const double tolerance = shape_tolerance * grid.smallest_spacing();
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    const bool is_held = description.clamps
                             ? description.clamps->contains(grid.node_position(node), tolerance)
                             : part.on_plate(node);
    held[offset] = is_held ? 1 : 0;
  });
  return held;
}

/// Refuses supports that leave a piece of part and substrate free to move as a rigid body.
template <int Dim>
void require_held_pieces(const Grid<Dim>& grid, const PieceMap<Dim>& map, const std::vector<int>& holding,
                         bool clamps) {
  for (std::size_t piece = 0; piece < map.pieces.size(); ++piece) {
    std::vector<int> of_piece;
    for (std::size_t e = 0; e < map.piece_of_element.size(); ++e)
      if (map.piece_of_element[e] == static_cast<int>(piece)) of_piece.push_back(static_cast<int>(e));
    const std::vector<char> nodes = nodes_of_elements(grid, of_piece);
    std::vector<int> of_both;
    std::copy_if(holding.begin(), holding.end(), std::back_inserter(of_both),
                 [&](int node) { return nodes[node] != 0; });
    if (RigidMotions<Dim>(grid, std::move(of_both)).determined()) continue;
    const std::string number = std::to_string(map.pieces[piece].elements);
    throw InputError(
        std::string(clamps ? "/clamps: the clamped nodes" : "/substrate: the nodes of its lowest face") +
        " leave a rigid motion of " +
        (map.pieces.size() == 1 ? "part and substrate"
                                : "a piece of " + number + " elements of part and substrate") +
        " free; needed: nodes that hold every face-connected piece of them");
  }
}

}  // namespace

template <int Dim>
Supports<Dim>::Supports(const Part<Dim>& part, const PartDescription& description)
    : held(held_nodes(part, description)) {
  const Grid<Dim>& grid = part.grid();
  for (std::size_t node = 0; node < held.size(); ++node) {
    const bool there = part.touched_nodes()[node] != 0 || part.substrate().nodes()[node] != 0;
    if (there && held[node] != 0) holding.push_back(static_cast<int>(node));
  }
  if (sum(grid.comm(), static_cast<std::int64_t>(holding.size())) == 0)
    throw InputError("/clamps: no node of part or substrate lies in or on the shape; needs at least " +
                     std::to_string(Dim));
  const PieceMap<Dim> map = find_pieces<Dim>(grid, part.solid(), part.plate());
  pieces = static_cast<int>(map.pieces.size());
  // The face of one element on the plate already holds every rigid motion.
  if (description.clamps || part.substrate().count() > 0)
    require_held_pieces(grid, map, holding, description.clamps.has_value());
}

FABSEQ_INSTANTIATE_STRUCT(Supports);

}  // namespace fabseq
