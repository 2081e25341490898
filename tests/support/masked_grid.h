// SPDX-License-Identifier: MIT
/// \file
/// Distributed grids of which only some elements are in the model, with their supports and lane vectors.
#pragma once

#include "fabseq/base/mpi.h"
#include "fabseq/grid/unknown_numbering.h"
#include "kernels/lane_array.h"
#include "kernels/lane_mesh.h"
#include "support/masked_box.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace fabseq::test {

/// A grid with a mask and unequal spacings, held at a plate.
template <int Dim>
struct MaskedGrid {
  /// Whether a component of a node is held.
  using Held = std::function<bool(const Index<Dim>&, int)>;

  MaskedGrid(MPI_Comm comm, const Index<Dim>& elements, const Mask<Dim>& mask, int components,
             const Held& held)
      : whole({Index<Dim>{}, elements}, mask), grid(comm, domain_of(elements), {}) {
    domain.components = components;
    grid.owned_elements().for_each([&](const Index<Dim>& index, std::int64_t) {
      if (mask.active(index)) domain.first_corners.push_back(grid.first_corner(index));
    });
    grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t) {
      for (int a = 0; a < components; ++a) domain.fixed.push_back(held(node, a) ? 1 : 0);
    });
  }
  MaskedGrid(MPI_Comm comm, const Index<Dim>& elements, const Mask<Dim>& mask, const BuildPlate& plate)
      : MaskedGrid(comm, elements, mask, Dim, on_plate(elements, plate)) {}

  static Domain<Dim> domain_of(const Index<Dim>& elements) {
    Domain<Dim> result{{}, elements, Dim == 2 ? 0.25 : 1.0};
    for (int axis = 0; axis < Dim; ++axis) result.size[axis] = (0.5 - 0.1 * axis) * elements[axis];
    return result;
  }
  static Held on_plate(const Index<Dim>& elements, const BuildPlate& plate) {
    return [elements, plate](const Index<Dim>& node, int) {
      return node[plate.axis] == (plate.upper ? elements[plate.axis] : 0);
    };
  }

  MaskedBox<Dim> whole;
  Grid<Dim> grid;
  SystemDomain domain;
};

/// Everything on the plate's nodes held but every other node, which slides along it; single unknowns held
/// here and there.
template <int Dim>
typename MaskedGrid<Dim>::Held mixed_supports() {
  return [](const Index<Dim>& node, int component) {
    std::int64_t number = component;
    for (const int i : node) number = number * 64 + i;
    const bool slides = node[0] % 2 == 1;
    return (node[Dim - 1] == 0 && (!slides || component == Dim - 1)) || noise(number, 4) < 0.05;
  };
}

/// f(node, its number) of all nodes of a mesh.
template <int Dim, class Function>
void for_each_node(const LaneMesh<Dim>& mesh, Function&& f) {
  mesh.node_box().for_each([&](const Index<Dim>& node, std::int64_t) {
    if (mesh.node_number(node) >= 0) f(node, mesh.node_number(node));
  });
}

/// Vector on a mesh, [node][component][lane], of f(unknown in the box `all` of nodes, lane).
template <int Dim, class Function>
LaneArray lane_array(const LaneMesh<Dim>& mesh, const IndexBox<Dim>& all, int components, int width,
                     Function&& f) {
  LaneArray result(static_cast<std::size_t>(mesh.nodes()) * components * width);
  for_each_node(mesh, [&](const Index<Dim>& node, std::int64_t number) {
    for (int i = 0; i < components * width; ++i)
      result[number * components * width + i] = f(all.offset(node) * components + i / width, i % width);
  });
  return result;
}

/// Coefficients on a mesh, [element][entry], of f(element in the box `all`, entry).
template <int Dim, class Function>
LaneArray coefficient_array(const LaneMesh<Dim>& mesh, const IndexBox<Dim>& all, int entries, Function&& f) {
  LaneArray result(static_cast<std::size_t>(mesh.elements()) * entries);
  mesh.element_box().for_each([&](const Index<Dim>& element, std::int64_t) {
    for (int i = 0; mesh.element_number(element) >= 0 && i < entries; ++i)
      result[static_cast<std::size_t>(mesh.element_number(element)) * entries + i] =
          f(all.offset(element), i);
  });
  return result;
}

/// A lane of a vector that is the same on all holders of a node, on all nodes of the grid; 0 where no mesh
/// has a node. Collective; fails where holders differ in a bit.
template <int Dim>
std::vector<double> whole_lane(MPI_Comm comm, const LaneMesh<Dim>& mesh, const IndexBox<Dim>& all,
                               const LaneArray& values, int components, int width, int lane) {
  const std::size_t size = static_cast<std::size_t>(all.count()) * components;
  std::vector<double> lowest(size, INFINITY), highest(size, -INFINITY);
  for_each_node(mesh, [&](const Index<Dim>& node, std::int64_t number) {
    for (int a = 0; a < components; ++a)
      lowest[all.offset(node) * components + a] = highest[all.offset(node) * components + a] =
          values[(number * components + a) * width + lane];
  });
  MPI_Allreduce(MPI_IN_PLACE, lowest.data(), static_cast<int>(size), MPI_DOUBLE, MPI_MIN, comm);
  MPI_Allreduce(MPI_IN_PLACE, highest.data(), static_cast<int>(size), MPI_DOUBLE, MPI_MAX, comm);
  for (std::size_t i = 0; i < size; ++i) {
    if (lowest[i] > highest[i]) lowest[i] = highest[i] = 0.0;
    EXPECT_EQ(lowest[i], highest[i]) << "holders of a node differ";
  }
  return lowest;
}

}  // namespace fabseq::test
