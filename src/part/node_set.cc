// SPDX-License-Identifier: MIT
#include "fabseq/part/node_set.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"
#include "fabseq/grid/element_halo.h"
#include "fabseq/mesh/near_surface.h"
#include "fabseq/mesh/read_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fabseq {

namespace {

/// Whether each owned node has an element of neither part nor substrate at it, or is at the edge of the box.
template <int Dim>
std::vector<char> surface_nodes(const Part<Dim>& part) {
  const Grid<Dim>& grid = part.grid();
  const ElementHalo<Dim> halo(grid, 1);
  const std::vector<double> solid = halo.gather(part.solid());
  std::vector<char> result(static_cast<std::size_t>(grid.owned_nodes().count()), 0);
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    for (int number = 0; number < 1 << Dim; ++number) {
      const Index<Dim> element = stepped<Dim>(node, number, -1);
      if (!halo.box().contains(element) || solid[halo.box().offset(element)] == 0.0) result[offset] = 1;
    }
  });
  return result;
}

/// Says how far a surface lies from the part, and how large it is, if its unit of length may be another; else
/// "".
template <int Dim>
std::string doubt_about_unit(const Part<Dim>& part, const TriangleMesh& mesh) {
  constexpr double far = 10.0, other_size = 500.0;  // of the part's length
  const Bounds box = bounds(mesh);
  double square = 0.0, size = 0.0;
  for (int axis = 0; axis < Dim; ++axis) {
    const double gap =
        std::max({0.0, box.low[axis] - part.upper()[axis], part.lower()[axis] - box.high[axis]});
    square += gap * gap;
    size = std::max(size, box.high[axis] - box.low[axis]);
  }
  const double away = std::sqrt(square), length = part.longest_edge();
  if (!(away > far * length || size * other_size < length || size > other_size * length)) return "";
  return formatted(
      "a mesh %.3g long that lies %.3g away from the part, which is %.3g long: perhaps its unit of "
      "length is another",
      size, away, length);
}

/// Whether each owned node lies near a surface; sets what doubt_about_unit() says.
template <int Dim>
std::vector<char> near_nodes(const Part<Dim>& part, const NearMesh& near, double tolerance,
                             const std::string& key, std::string& doubt) {
  const Grid<Dim>& grid = part.grid();
  if constexpr (Dim == 3) {
    const std::string unit = part.mesh() != nullptr ? part.mesh()->unit() : "";
    TriangleMesh mesh = read_mesh(grid.comm(), near.file, key + "/near/mesh", unit).mesh;
    if (part.mesh() != nullptr) mesh = part.mesh()->placed(std::move(mesh));
    doubt = doubt_about_unit(part, mesh);
    return nodes_near(mesh, near.distance + tolerance, grid.domain(), grid.owned_nodes());
  }
  throw InputError(key + "/near: in a plane, needs a domain of 3 dimensions");
}

template <int Dim>
std::vector<int> find_owned_nodes(const Part<Dim>& part, const NodeSetDescription& description,
                                  const std::string& key, std::string& doubt) {
  const Grid<Dim>& grid = part.grid();
  const double tolerance = std::max(description.within, shape_tolerance * grid.smallest_spacing());
  const std::vector<char> surface = description.surface ? surface_nodes<Dim>(part) : std::vector<char>{};
  const std::vector<char> near =
      description.near ? near_nodes(part, *description.near, tolerance, key, doubt) : std::vector<char>{};
  std::vector<int> owned;
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    if (!surface.empty() && surface[offset] == 0) return;
    const bool of_part = part.touched_nodes()[offset] != 0;
    const bool there = of_part || part.substrate().nodes()[offset] != 0;
    const bool in_set = description.all ? of_part
                        : near.empty()
                            ? there && description.shape.contains(grid.node_position(node), tolerance)
                            : there && near[offset] != 0;
    if (in_set) owned.push_back(static_cast<int>(offset));
  });
  return owned;
}

/// Axis of the longest edge of the bounding box of `nodes`; the first of equally long ones.
template <int Dim>
int longest_axis(const std::vector<Index<Dim>>& nodes, const Point<Dim>& spacing) {
  int longest = 0;
  double longest_edge = -1.0;
  for (int axis = 0; axis < Dim; ++axis) {
    int low = std::numeric_limits<int>::max(), high = 0;
    for (const Index<Dim>& node : nodes) {
      low = std::min(low, node[axis]);
      high = std::max(high, node[axis]);
    }
    const double edge = (high - low) * spacing[axis];
    // Edges of equal length may differ by the rounding of the spacings.
    if (longest_edge >= 0.0 && edge <= longest_edge * (1.0 + 1e-9)) continue;
    longest = axis;
    longest_edge = edge;
  }
  return longest;
}

/// Chooses `samples` of the nodes, which are given by lexicographic number, equally spaced in their order
/// along the longest edge of their bounding box. The result is sorted by number.
template <int Dim>
std::vector<std::int64_t> equally_spaced(const Grid<Dim>& grid, const std::vector<std::int64_t>& numbers,
                                         int samples) {
  const IndexBox<Dim> all = grid.all_nodes();
  std::vector<Index<Dim>> nodes;
  for (const std::int64_t number : numbers) nodes.push_back(all.index(number));
  const int axis = longest_axis<Dim>(nodes, grid.spacing());
  std::vector<std::pair<int, std::int64_t>> order;  // index along the axis, then number
  for (std::size_t i = 0; i < nodes.size(); ++i) order.emplace_back(nodes[i][axis], numbers[i]);
  std::sort(order.begin(), order.end());

  std::vector<std::int64_t> chosen;
  const auto last = static_cast<std::int64_t>(order.size()) - 1;
  const std::int64_t steps = std::max(samples - 1, 1);
  for (std::int64_t i = 0; i < samples; ++i)  // floor(i (n-1)/(k-1) + 1/2) in integers
    chosen.push_back(order[(2 * i * last + steps) / (2 * steps)].second);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

/// Removes this rank's nodes that are not among the chosen samples.
template <int Dim>
void keep_samples(const Grid<Dim>& grid, int samples, std::vector<int>& owned) {
  const auto number = [&](int offset) { return grid.all_nodes().offset(grid.owned_nodes().index(offset)); };
  std::vector<std::int64_t> own;
  for (const int offset : owned) own.push_back(number(offset));
  const std::vector<std::int64_t> chosen = equally_spaced<Dim>(grid, gather_all(grid.comm(), own), samples);
  std::erase_if(
      owned, [&](int offset) { return !std::binary_search(chosen.begin(), chosen.end(), number(offset)); });
}

}  // namespace

template <int Dim>
NodeSet make_node_set(const Part<Dim>& part, const std::string& name, const NodeSetDescription& description) {
  const MPI_Comm comm = part.grid().comm();
  const std::string key = "/node_sets/" + name;
  NodeSet set;
  set.name = name;
  std::string doubt;
  set.owned = find_owned_nodes<Dim>(part, description, key, doubt);
  set.count = sum(comm, static_cast<std::int64_t>(set.owned.size()));
  if (set.count == 0)
    throw InputError(key +
                     ": no node that touches the part or the substrate lies in or on the shape or near the "
                     "mesh, needs at least one" +
                     (doubt.empty() ? "" : "; found " + doubt));
  if (!doubt.empty()) warn(key + "/near/mesh: found " + doubt);
  if (description.samples < 0 || description.samples > set.count)
    throw InputError(key + "/samples: " + std::to_string(description.samples) + " of a set of " +
                     std::to_string(set.count) + " nodes, needs 0 (all) to " + std::to_string(set.count));
  if (description.samples > 0) {
    keep_samples<Dim>(part.grid(), description.samples, set.owned);
    set.count = description.samples;
  }
  return set;
}

template <int Dim>
std::map<std::string, NodeSet> make_node_sets(const Part<Dim>& part,
                                              const std::map<std::string, NodeSetDescription>& descriptions) {
  std::map<std::string, NodeSet> result;
  for (const auto& [name, description] : descriptions)
    result.emplace(name, make_node_set(part, name, description));
  return result;
}

FABSEQ_INSTANTIATE_FUNCTION(make_node_set);
FABSEQ_INSTANTIATE_FUNCTION(make_node_sets);

}  // namespace fabseq
