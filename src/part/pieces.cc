// SPDX-License-Identifier: MIT
#include "fabseq/part/pieces.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/components.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace fabseq {

namespace {

/// Sizes, bounding boxes and plate contact of pieces: this rank's share until reduce(), afterwards that of
/// all ranks.
template <int Dim>
struct PieceMeasures {
  explicit PieceMeasures(std::size_t pieces)
      : counts(2 * pieces), extremes(2 * Dim * pieces, -std::numeric_limits<double>::infinity()) {}

  void add(int piece, const Index<Dim>& element, bool touches_plate) {
    counts[2 * piece] += 1;
    counts[2 * piece + 1] += touches_plate ? 1 : 0;
    for (int axis = 0; axis < Dim; ++axis) {
      double* extreme = &extremes[2 * (Dim * piece + axis)];
      extreme[0] = std::max<double>(extreme[0], -element[axis]);
      extreme[1] = std::max<double>(extreme[1], element[axis] + 1);
    }
  }
  void reduce(MPI_Comm comm) {
    sum_in_place(comm, counts);
    max_in_place(comm, extremes);
  }
  Piece<Dim> piece(int number, const Grid<Dim>& grid) const {
    Piece<Dim> result;
    result.elements = counts[2 * number];
    result.touches_plate = counts[2 * number + 1] > 0;
    for (int axis = 0; axis < Dim; ++axis) {
      const double* extreme = &extremes[2 * (Dim * number + axis)];
      const double origin = grid.domain().origin[axis], spacing = grid.spacing()[axis];
      result.min[axis] = origin + -extreme[0] * spacing;
      result.max[axis] = origin + extreme[1] * spacing;
    }
    return result;
  }

  std::vector<std::int64_t> counts;  ///< [piece][2]: elements, and those with a face on plate or substrate
  std::vector<double> extremes;      ///< [piece][axis][2]: -(lowest index), and highest index + 1
};

}  // namespace

template <int Dim>
PieceMap<Dim> find_pieces(const Grid<Dim>& grid, std::span<const double> density, const BuildPlate& plate,
                          std::span<const double> to_substrate) {
  Components components = find_components<Dim>(grid, density, Contact::face);
  PieceMeasures<Dim> measures(static_cast<std::size_t>(components.count));
  grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t offset) {
    if (components.of_element[offset] < 0) return;
    const bool stands = plate.touches<Dim>(element, grid.domain().elements) ||
                        (!to_substrate.empty() && std::isfinite(to_substrate[offset]));
    measures.add(components.of_element[offset], element, stands);
  });
  measures.reduce(grid.comm());

  // The largest piece comes first. A stable sort keeps pieces of equal size in the order of their lowest
  // elements.
  std::vector<int> order(static_cast<std::size_t>(components.count)), rank_of_piece(order.size());
  PieceMap<Dim> map;
  map.piece_of_element = std::move(components.of_element);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return measures.counts[2 * a] > measures.counts[2 * b]; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    rank_of_piece[order[i]] = static_cast<int>(i);
    map.pieces.push_back(measures.piece(order[i], grid));
  }
  for (int& piece : map.piece_of_element)
    if (piece >= 0) piece = rank_of_piece[piece];
  return map;
}

FABSEQ_INSTANTIATE_FUNCTION(find_pieces);

}  // namespace fabseq
