// SPDX-License-Identifier: MIT
#include "fabseq/sequence/geodesic_distance.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/element_halo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace fabseq {

namespace {

constexpr double far_away = std::numeric_limits<double>::infinity();
/// Sweeping ends when no value changes by more than this share of itself.
constexpr double settled = 1e-13;

/// Data of the upwind difference along one axis: the smaller value of the two neighbours, and the distance to
/// them.
struct Upwind {
  double value;
  double spacing;
};

/// Solution s of sum_a max(0, (s - value_a) / spacing_a)^2 = 1 (Godunov's upwind scheme). The left side grows
/// with s, and only axes with value_a < s count. So axes are taken in ascending order of their values until
/// the next value lies above s.
template <int Dim>
double solve_upwind(std::array<Upwind, Dim> neighbors) {
  std::sort(neighbors.begin(), neighbors.end(),
            [](const Upwind& a, const Upwind& b) { return a.value < b.value; });
  const double base = neighbors[0].value;
  if (base == far_away) return far_away;
  // With r = s - base, u_a = value_a - base, w_a = 1/spacing_a^2:  A r^2 - 2 B r + C = 0.
  double a = 0.0, b = 0.0, c = -1.0, r = far_away;
  for (const Upwind& neighbor : neighbors) {
    const double u = neighbor.value - base;
    if (u >= r) break;
    const double w = 1.0 / (neighbor.spacing * neighbor.spacing);
    a += w;
    b += w * u;
    c += w * u * u;
    r = (b + std::sqrt(std::max(0.0, b * b - a * c))) / a;
  }
  return base + r;
}

/// The elements or nodes that a front runs through, in the box of this rank.
template <int Dim>
struct Network {
  Point<Dim> spacing{};
  IndexBox<Dim> owned, box;  ///< this rank's; the same and those around them
  /// Owned entries: the distance if it is given, otherwise far_away.
  std::vector<double> distance;
  /// Owned entries: bit (2 axis + end) says that the front may come from the neighbour below (end 0) or above
  /// (end 1) along the axis. No bit is set if the distance is given or the entry is not part of the network.
  std::vector<unsigned> links;
  /// Turns owned values into values on `box`. Collective.
  std::function<std::vector<double>(const std::vector<double>&)> gather;
};

constexpr unsigned link(int axis, int end) { return 1U << (2 * axis + end); }

/// The distances in a rank's box, and the sweeps over them.
template <int Dim>
class Sweeper {
 public:
  explicit Sweeper(const Network<Dim>& network)
      : network_(network), values_(network.gather(network.distance)) {
    std::int64_t stride = 1;
    for (int axis = 0; axis < Dim; ++axis) {
      strides_[axis] = stride;
      stride *= network_.box.size[axis];
    }
  }

  /// Sweeps in all directions over the owned entries: if bit a of `direction` is set, from the upper end of
  /// axis a. Returns true if a value changed by more than `settled`.
  bool sweep() {
    const IndexBox<Dim>& owned = network_.owned;
    bool changed = false;
    for (int direction = 0; direction < (1 << Dim); ++direction)
      owned.for_each([&](const Index<Dim>& forward, std::int64_t) {
        Index<Dim> index = forward;
        for (int axis = 0; axis < Dim; ++axis)
          if ((direction >> axis) & 1)
            index[axis] = 2 * owned.start[axis] + owned.size[axis] - 1 - forward[axis];
        const unsigned links = network_.links[owned.offset(index)];
        if (links != 0) changed |= update(network_.box.offset(index), links);
      });
    return changed;
  }
  /// Takes over the values of the neighbouring ranks. Returns true if any of them is new. Collective.
  bool exchange() {
    std::vector<double> gathered = network_.gather(owned_values());
    const bool news = gathered != values_;
    values_ = std::move(gathered);
    return news;
  }

  std::vector<double> owned_values() const {
    std::vector<double> result(static_cast<std::size_t>(network_.owned.count()));
    network_.owned.for_each([&](const Index<Dim>& index, std::int64_t offset) {
      result[offset] = values_[network_.box.offset(index)];
    });
    return result;
  }

 private:
  bool update(std::int64_t here, unsigned links) {
    std::array<Upwind, Dim> neighbors;
    for (int axis = 0; axis < Dim; ++axis) {
      const bool below = (links & link(axis, 0)) != 0, above = (links & link(axis, 1)) != 0;
      neighbors[axis] = {std::min(below ? values_[here - strides_[axis]] : far_away,
                                  above ? values_[here + strides_[axis]] : far_away),
                         network_.spacing[axis]};
    }
    const double value = solve_upwind<Dim>(neighbors);
    if (!(value < values_[here])) return false;
    const bool changed = values_[here] - value > settled * value;
    values_[here] = value;
    return changed;
  }

  const Network<Dim>& network_;
  std::vector<double> values_;  ///< on the box; far_away outside the network and while unknown
  std::array<std::int64_t, Dim> strides_{};
};

/// Distances of the owned elements or nodes. Collective on `comm`.
template <int Dim>
std::vector<double> sweep_until_settled(MPI_Comm comm, const Network<Dim>& network) {
  Sweeper<Dim> sweeper(network);
  // Values only fall, and the scheme has one solution, whatever the order of updates. So ranks may sweep on
  // their own.
  bool unsettled = true;
  while (true) {
    const bool changed = unsettled && sweeper.sweep();
    if (!any(comm, changed)) break;
    unsettled = sweeper.exchange() || changed;
  }
  return sweeper.owned_values();
}

/// Part field of distances. `given`: the known ones, far_away for all other elements. Collective.
template <int Dim>
std::vector<double> distance_of_elements(const Part<Dim>& part, std::span<const double> given) {
  const Grid<Dim>& grid = part.grid();
  const ElementHalo<Dim> halo(grid, 1);
  Network<Dim> network{
      grid.spacing(), grid.owned_elements(), halo.box(), part.expand(given, far_away), {}, {}};
  network.links.assign(network.distance.size(), 0U);
  for (std::size_t e = 0; e < given.size(); ++e) {
    if (given[e] != far_away) continue;
    const Index<Dim> element = network.owned.index(part.elements()[e]);
    for (int axis = 0; axis < Dim; ++axis) {
      unsigned& links = network.links[part.elements()[e]];
      if (element[axis] > 0) links |= link(axis, 0);
      if (element[axis] + 1 < grid.domain().elements[axis]) links |= link(axis, 1);
    }
  }
  network.gather = [&halo](const std::vector<double>& owned) { return halo.gather(owned); };
  return part.restrict_to_part(sweep_until_settled(grid.comm(), network));
}

/// Network::links of the owned nodes: one link per edge of a part element. Collective.
template <int Dim>
std::vector<unsigned> edges_of_nodes(const Part<Dim>& part) {
  constexpr int directions = 2 * Dim;
  const Grid<Dim>& grid = part.grid();
  std::vector<double> ghosted(static_cast<std::size_t>(grid.ghosted_nodes().count()) * directions, 0.0);
  for (const int first : part.first_corners())
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      double* edges = &ghosted[static_cast<std::size_t>(first + grid.corner_offsets()[corner]) * directions];
      for (int axis = 0; axis < Dim; ++axis) edges[2 * axis + (((corner >> axis) & 1) == 0 ? 1 : 0)] = 1.0;
    }
  std::vector<double> owned(static_cast<std::size_t>(grid.owned_nodes().count()) * directions);
  grid.exchange(directions).add_to_owned(ghosted, owned);
  std::vector<unsigned> links(owned.size() / directions, 0U);
  for (std::size_t i = 0; i < owned.size(); ++i)
    if (owned[i] > 0.0) links[i / directions] |= 1U << (i % directions);
  return links;
}

}  // namespace

template <int Dim>
std::vector<double> geodesic_distance(const Part<Dim>& part) {
  return distance_of_elements<Dim>(part, part.contact_distance());
}

template <int Dim>
std::vector<double> geodesic_distance_of_elements(const Part<Dim>& part, std::span<const char> start) {
  std::vector<double> given;
  for (const char starts : start) given.push_back(starts != 0 ? 0.0 : far_away);
  return distance_of_elements(part, given);
}

template <int Dim>
std::vector<double> geodesic_distance_of_nodes(const Part<Dim>& part, std::span<const char> start) {
  const Grid<Dim>& grid = part.grid();
  Network<Dim> network{
      grid.spacing(), grid.owned_nodes(), grid.ghosted_nodes(), {}, edges_of_nodes(part), {}};
  for (std::size_t node = 0; node < start.size(); ++node) {
    network.distance.push_back(start[node] != 0 ? 0.0 : far_away);
    if (start[node] != 0) network.links[node] = 0U;
  }
  network.gather = [&grid](const std::vector<double>& owned) { return grid.exchange(1).ghosted(owned); };
  return sweep_until_settled(grid.comm(), network);
}

template <int Dim>
double geodesic_height(const Part<Dim>& part, const std::vector<double>& distance) {
  double farthest = 0.0;
  for (const double value : distance) farthest = std::max(farthest, value);
  return max(part.grid().comm(), farthest) + 0.5 * part.grid().spacing()[part.plate().axis];
}

FABSEQ_INSTANTIATE_FUNCTION(geodesic_distance);
FABSEQ_INSTANTIATE_FUNCTION(geodesic_distance_of_elements);
FABSEQ_INSTANTIATE_FUNCTION(geodesic_distance_of_nodes);
FABSEQ_INSTANTIATE_FUNCTION(geodesic_height);

}  // namespace fabseq
