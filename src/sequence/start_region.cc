// SPDX-License-Identifier: MIT
#include "fabseq/sequence/start_region.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/sequence/geodesic_distance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

namespace fabseq {

namespace {

/// 1 for the owned nodes of the part in or on the shape or, without a shape, on the plate or the substrate.
template <int Dim>
std::vector<char> nodes_in_region(const Part<Dim>& part, const std::optional<Shape>& shape) {
  const Grid<Dim>& grid = part.grid();
  const double tolerance = shape_tolerance * grid.smallest_spacing();
  std::vector<char> result(part.touched_nodes().size(), 0);
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    if (part.touched_nodes()[offset] == 0) return;
    const bool in = shape ? shape->contains(grid.node_position(node), tolerance)
                          : part.on_plate(node) || part.substrate().nodes()[offset] != 0;
    result[offset] = in ? 1 : 0;
  });
  return result;
}

/// Part field: 1 for elements with at least `least` of the flagged nodes. Collective.
template <int Dim>
std::vector<char> elements_with_corners(const Part<Dim>& part, const std::vector<char>& nodes, int least) {
  const Grid<Dim>& grid = part.grid();
  const auto ghosted = grid.exchange(1).ghosted(std::vector<double>(nodes.begin(), nodes.end()));
  std::vector<char> result;
  for (const int first : part.first_corners()) {
    int count = 0;
    for (const int corner : grid.corner_offsets()) count += ghosted[first + corner] > 0.0 ? 1 : 0;
    result.push_back(count >= least ? 1 : 0);
  }
  return result;
}

std::int64_t count(MPI_Comm comm, const std::vector<char>& flags) {
  return sum(comm, static_cast<std::int64_t>(std::count(flags.begin(), flags.end(), 1)));
}

/// Part field: 1 for the elements of the region. Without a shape these have a face on the plate or the
/// substrate.
template <int Dim>
std::vector<char> elements_in_region(const Part<Dim>& part, const std::optional<Shape>& shape) {
  std::vector<char> elements;
  if (!shape) {
    for (const double distance : part.contact_distance()) elements.push_back(std::isfinite(distance) ? 1 : 0);
    return elements;
  }
  const Grid<Dim>& grid = part.grid();
  const double tolerance = shape_tolerance * grid.smallest_spacing();
  for (const int element : part.elements()) {
    const Point<Dim> center = grid.element_center(grid.owned_elements().index(element));
    elements.push_back(shape->contains(center, tolerance) ? 1 : 0);
  }
  if (count(grid.comm(), elements) > 0) return elements;
  return elements_with_corners(part, nodes_in_region(part, shape), 1);
}

[[noreturn]] void refuse_region(const std::string& text) { throw InputError("/sequence/start: " + text); }

/// Sets the initial values at the free places from the distances everywhere. Throws InputError if some of
/// these are infinite. Collective.
void set_initial_time(MPI_Comm comm, const std::vector<double>& distance, const char* what,
                      StartRegion& region) {
  double farthest = 0.0;
  std::int64_t unreachable = 0;
  for (const int place : region.free) {
    region.initial_time.push_back(distance[place]);
    if (std::isfinite(distance[place]))
      farthest = std::max(farthest, distance[place]);
    else
      ++unreachable;
  }
  farthest = max(comm, farthest);
  unreachable = sum(comm, unreachable);
  if (unreachable > 0)
    refuse_region(std::to_string(unreachable) + what +
                  " of the part cannot be reached from it inside the part, needs some of every piece");
  for (double& time : region.initial_time) time /= farthest;
}

template <int Dim>
StartRegion region_of_elements(const Part<Dim>& part, const std::optional<Shape>& shape) {
  const MPI_Comm comm = part.grid().comm();
  StartRegion region;
  region.elements = elements_in_region(part, shape);
  const std::int64_t fixed = count(comm, region.elements);
  if (fixed == 0)
    refuse_region("no element of the part has its centre or a node in or on the shape, needs at least one");
  if (fixed == part.count()) refuse_region("holds all elements of the part, needs at least one outside");
  for (std::size_t e = 0; e < region.elements.size(); ++e)
    if (region.elements[e] == 0) region.free.push_back(part.elements()[e]);
  const std::vector<double> distance = part.expand(geodesic_distance_of_elements<Dim>(part, region.elements));
  set_initial_time(comm, distance, " elements", region);
  return region;
}

template <int Dim>
StartRegion region_of_nodes(const Part<Dim>& part, const std::optional<Shape>& shape) {
  const MPI_Comm comm = part.grid().comm();
  std::vector<char> nodes = nodes_in_region(part, shape);
  if (count(comm, nodes) == 0)
    refuse_region("no node that touches the part lies in or on the shape, needs at least one");
  // The substrate stands before anything is built.
  for (std::size_t node = 0; node < nodes.size(); ++node)
    if (part.touched_nodes()[node] != 0 && part.substrate().nodes()[node] != 0) nodes[node] = 1;
  if (count(comm, nodes) == count(comm, part.touched_nodes()))
    refuse_region("holds all nodes of the part, needs at least one outside");
  StartRegion region;
  region.elements = elements_with_corners(part, nodes, corner_count<Dim>);
  for (std::size_t node = 0; node < nodes.size(); ++node)
    if (part.touched_nodes()[node] != 0 && nodes[node] == 0) region.free.push_back(static_cast<int>(node));
  set_initial_time(comm, geodesic_distance_of_nodes<Dim>(part, nodes), " nodes", region);
  return region;
}

}  // namespace

template <int Dim>
StartRegion make_start_region(const Part<Dim>& part, DesignLocation location,
                              const std::optional<Shape>& shape) {
  return location == DesignLocation::nodes ? region_of_nodes(part, shape) : region_of_elements(part, shape);
}

FABSEQ_INSTANTIATE_FUNCTION(make_start_region);

}  // namespace fabseq
