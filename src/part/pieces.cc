// SPDX-License-Identifier: MIT
#include "fabseq/part/pieces.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/box_gather.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace fabseq {

namespace {

/// Calls f(neighbour) for the elements of `box` that share a face with `element`.
template <int Dim, class Function>
void for_each_face_neighbor(const IndexBox<Dim>& box, const Index<Dim>& element, Function&& f) {
  for (int axis = 0; axis < Dim; ++axis)
    for (const int step : {-1, 1}) {
      Index<Dim> neighbor = element;
      neighbor[axis] += step;
      if (box.contains(neighbor)) f(neighbor);
    }
}

/// Face-connected components of this rank's elements alone, numbered in the order of their lowest elements.
struct LocalComponents {
  std::vector<int> of_element;      ///< component of each owned element, -1 outside the part
  std::vector<std::int64_t> first;  ///< number, in the whole grid, of each component's lowest element
};

template <int Dim>
LocalComponents flood_fill(const Grid<Dim>& grid, std::span<const double> density) {
  const IndexBox<Dim>& box = grid.owned_elements();
  const IndexBox<Dim> all = grid.all_elements();
  LocalComponents components;
  components.of_element.assign(density.size(), -1);
  std::vector<std::int64_t> pending;
  int component = 0;
  const auto visit = [&](const Index<Dim>& element) {
    const std::int64_t offset = box.offset(element);
    if (!(density[offset] > 0.0) || components.of_element[offset] >= 0) return;
    components.of_element[offset] = component;
    pending.push_back(offset);
  };
  box.for_each([&](const Index<Dim>& seed, std::int64_t) {
    visit(seed);
    if (pending.empty()) return;
    components.first.push_back(all.offset(seed));
    while (!pending.empty()) {
      const Index<Dim> element = box.index(pending.back());
      pending.pop_back();
      for_each_face_neighbor<Dim>(box, element, visit);
    }
    ++component;
  });
  return components;
}

/// A face between a local component and an element of another rank.
struct Contact {
  int component;
  std::int64_t neighbor;  ///< offset in the box with the elements around this rank's
};

template <int Dim>
std::vector<Contact> contacts_of(const IndexBox<Dim>& box, const LocalComponents& components) {
  const IndexBox<Dim> ring = ringed(box);
  std::vector<Contact> contacts;
  box.for_each([&](const Index<Dim>& element, std::int64_t offset) {
    if (components.of_element[offset] < 0) return;
    for_each_face_neighbor<Dim>(ring, element, [&](const Index<Dim>& neighbor) {
      if (!box.contains(neighbor)) contacts.push_back({components.of_element[offset], ring.offset(neighbor)});
    });
  });
  return contacts;
}

/// Label of each local component: the lowest element of its piece, as a lexicographic number in the whole
/// grid. Each round carries labels across one boundary between ranks, so the number of rounds is that of the
/// boundaries that a piece winds through. Collective.
template <int Dim>
std::vector<std::int64_t> join_components(const Grid<Dim>& grid, const LocalComponents& components) {
  constexpr std::int64_t nothing = -1;
  const IndexBox<Dim>& box = grid.owned_elements();
  const BoxGather<Dim> around(grid.comm(), box, ringed(box));
  const std::vector<Contact> contacts = contacts_of<Dim>(box, components);
  std::vector<std::int64_t> labels = components.first;
  bool changed = true;
  while (any(grid.comm(), changed)) {
    changed = false;
    const auto label_at = [&](const Index<Dim>& element) {
      const int component = components.of_element[box.offset(element)];
      return component < 0 ? nothing : labels[component];
    };
    const auto extended = around.template gather<std::int64_t>(label_at, nothing);
    for (const Contact& contact : contacts) {
      const std::int64_t label = extended[contact.neighbor];
      if (label < 0 || label >= labels[contact.component]) continue;
      labels[contact.component] = label;
      changed = true;
    }
  }
  return labels;
}

/// Labels of all pieces, ascending, on all ranks. The rank that owns the element a label names contributes
/// the label.
std::vector<std::int64_t> gather_labels(MPI_Comm comm, const std::vector<std::int64_t>& first,
                                        const std::vector<std::int64_t>& labels) {
  std::vector<std::int64_t> own;
  for (std::size_t c = 0; c < first.size(); ++c)
    if (first[c] == labels[c]) own.push_back(first[c]);
  std::vector<std::int64_t> all = gather_all(comm, own);
  std::sort(all.begin(), all.end());
  return all;
}

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
  const LocalComponents components = flood_fill<Dim>(grid, density);
  const std::vector<std::int64_t> labels = join_components<Dim>(grid, components);
  const std::vector<std::int64_t> all_labels = gather_labels(grid.comm(), components.first, labels);

  PieceMap<Dim> map;
  map.piece_of_element.assign(density.size(), -1);
  PieceMeasures<Dim> measures(all_labels.size());
  grid.owned_elements().for_each([&](const Index<Dim>& element, std::int64_t offset) {
    if (components.of_element[offset] < 0) return;
    const std::int64_t label = labels[components.of_element[offset]];
    const auto piece = std::lower_bound(all_labels.begin(), all_labels.end(), label) - all_labels.begin();
    map.piece_of_element[offset] = static_cast<int>(piece);
    const bool stands = plate.touches<Dim>(element, grid.domain().elements) ||
                        (!to_substrate.empty() && std::isfinite(to_substrate[offset]));
    measures.add(static_cast<int>(piece), element, stands);
  });
  measures.reduce(grid.comm());

  // The largest piece comes first. A stable sort keeps pieces of equal size in the order of their lowest
  // elements.
  std::vector<int> order(all_labels.size()), rank_of_piece(all_labels.size());
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
