// SPDX-License-Identifier: MIT
#include "fabseq/lanes/lane_hierarchy.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/rigid_fit.h"

#include <algorithm>
#include <limits>

namespace fabseq {

namespace {

/// Calls f(numbers of the coarse nodes that a fine one interpolates from, number of the fine one) for all
/// nodes of this rank.
template <int Dim, class Function>
void for_each_node(const LaneLevel<Dim>& fine, const LaneMesh<Dim>& coarse, Function&& f) {
  std::vector<std::int64_t> numbers;
  fine.mesh.node_box().for_each([&](const Index<Dim>& node, std::int64_t) {
    const std::int64_t number = fine.mesh.node_number(node);
    if (number < 0) return;
    IndexBox<Dim> sources;
    for (int axis = 0; axis < Dim; ++axis) {
      sources.start[axis] = node[axis] / fine.factors[axis];
      sources.size[axis] = 1 + (node[axis] % fine.factors[axis] != 0 ? 1 : 0);
    }
    numbers.clear();
    sources.for_each(
        [&](const Index<Dim>& source, std::int64_t) { numbers.push_back(coarse.node_number(source)); });
    f(numbers, number);
  });
}

}  // namespace

template <int Dim>
std::vector<Point<Dim>> LaneLevel<Dim>::node_positions() const {
  std::vector<Point<Dim>> positions(static_cast<std::size_t>(mesh.nodes()));
  for (const auto& run : mesh.node_runs())
    for (int i = 0; i < run.length; ++i)
      for (int axis = 0; axis < Dim; ++axis)
        positions[run.node + i][axis] = (run.index[axis] + (axis == 0 ? i : 0)) * spacing[axis];
  return positions;
}

template <int Dim, class Real>
void sum_over_holders(LaneLevel<Dim>& level, Real* values, int entries) {
  const auto& nodes = level.shared.nodes();
  if (!level.distributed) return;
  std::vector<Real> packed(nodes.size() * entries);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    std::copy_n(values + nodes[i] * entries, entries, &packed[i * entries]);
  level.shared.sum(std::span(packed), entries);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    std::copy_n(&packed[i * entries], entries, values + nodes[i] * entries);
}

template <int Dim>
LaneHierarchy<Dim>::LaneHierarchy(const Grid<Dim>& grid, const SystemDomain& domain)
    : grid_(grid), components_(domain.components) {
  make_finest(domain);
  while (coarsen()) {
  }
}

template <int Dim>
void LaneHierarchy<Dim>::make_finest(const SystemDomain& domain) {
  LaneLevel<Dim>& finest = levels_.emplace_back();
  const IndexBox<Dim>& box = grid_.owned_elements();
  std::vector<char> active(static_cast<std::size_t>(box.count()), 0);
  for (const int corner : domain.first_corners) active[box.offset(grid_.ghosted_nodes().index(corner))] = 1;
  finest.mesh = LaneMesh<Dim>(box, active);
  finest.spacing = grid_.spacing();
  finest.elements = grid_.all_elements().size;
  finest.distributed = size_of(grid_.comm()) > 1;
  set_up_sums(finest);

  std::vector<double> owned(domain.fixed.begin(), domain.fixed.end());
  std::vector<double> ghosted(static_cast<std::size_t>(grid_.ghosted_nodes().count()) * components_);
  grid_.exchange(components_).to_ghosted(owned, ghosted);
  finest.mesh.node_box().for_each([&](const Index<Dim>& node, std::int64_t) {
    const std::int64_t number = finest.mesh.node_number(node);
    if (number < 0) return;
    for (int a = 0; a < components_; ++a)
      if (ghosted[grid_.ghosted_nodes().offset(node) * components_ + a] != 0.0)
        finest.fixed.push_back(number * components_ + a);
  });
}

template <int Dim>
void LaneHierarchy<Dim>::set_up_sums(LaneLevel<Dim>& level) {
  std::vector<char> counted(static_cast<std::size_t>(level.mesh.nodes()), 1);
  if (level.distributed) {
    level.comm = grid_.comm();
    level.shared = SharedNodes(level.comm, level.mesh);
    level.mesh.set_shared(level.shared.nodes());
    for (std::size_t i = 0; i < level.shared.nodes().size(); ++i)
      counted[level.shared.nodes()[i]] = level.shared.counted()[i];
  }
  for (std::int64_t node = 0; node < level.mesh.nodes(); ++node) {
    if (counted[node] == 0) continue;
    if (level.counted.empty() || level.counted.back().end != node) level.counted.push_back({node, node});
    level.counted.back().end = node + 1;
  }
}

template <int Dim>
std::vector<std::int64_t> LaneHierarchy<Dim>::element_numbers(const SystemDomain& domain) const {
  std::vector<std::int64_t> numbers;
  for (const int corner : domain.first_corners)
    numbers.push_back(level(0).mesh.element_number(grid_.ghosted_nodes().index(corner)));
  return numbers;
}

template <int Dim>
Index<Dim> LaneHierarchy<Dim>::choose_factors(const Index<Dim>& elements, const Point<Dim>& spacing,
                                              std::int64_t active) {
  Index<Dim> factors;
  factors.fill(1);
  if (active <= coarsest_elements) return factors;
  double shortest = std::numeric_limits<double>::max();
  for (int axis = 0; axis < Dim; ++axis)
    if (elements[axis] > 1) shortest = std::min(shortest, spacing[axis]);
  for (int axis = 0; axis < Dim; ++axis)
    if (elements[axis] > 1 && spacing[axis] < 1.5 * shortest) factors[axis] = 2;
  return factors;
}

template <int Dim>
bool LaneHierarchy<Dim>::begins_on_next(const Index<Dim>& start, const Index<Dim>& factors) {
  bool aligned = true;
  for (int axis = 0; axis < Dim; ++axis) aligned = aligned && start[axis] % factors[axis] == 0;
  return aligned;
}

/// Distributed levels need every rank's first element on the coarse grid, and enough to do.
template <int Dim>
bool LaneHierarchy<Dim>::keep_distributed(const LaneLevel<Dim>& fine, std::int64_t coarse_elements) const {
  const MPI_Comm comm = grid_.comm();
  if (!fine.distributed || !enough_for(size_of(comm), coarse_elements)) return false;
  return !any(comm, !begins_on_next(fine.mesh.element_box().start, fine.factors));
}

template <int Dim>
bool LaneHierarchy<Dim>::coarsen() {
  LaneLevel<Dim>& fine = levels_.back();
  const std::int64_t own = fine.mesh.elements();
  fine.factors = choose_factors(fine.elements, fine.spacing, fine.distributed ? sum(grid_.comm(), own) : own);
  // The last level is whole on every rank: a copy of this one if that is distributed.
  if (*std::max_element(fine.factors.begin(), fine.factors.end()) == 1 && !fine.distributed) return false;
  LaneLevel<Dim>& coarse = levels_.emplace_back();
  make_coarse_mesh(fine, coarse);
  set_up_sums(coarse);
  fine.transfer = LaneTransfer<Dim>(fine.mesh, coarse.mesh, fine.factors);
  fine.parent.resize(static_cast<std::size_t>(fine.mesh.elements()));
  fine.mesh.element_box().for_each([&](Index<Dim> element, std::int64_t) {
    const int number = fine.mesh.element_number(element);
    if (number < 0) return;
    for (int axis = 0; axis < Dim; ++axis) element[axis] /= fine.factors[axis];
    fine.parent[number] = coarse.mesh.element_number(element);
  });
  find_fixed(fine, coarse);
  return true;
}

template <int Dim>
void LaneHierarchy<Dim>::make_coarse_mesh(const LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse) {
  IndexBox<Dim> own = fine.mesh.element_box();
  for (int axis = 0; axis < Dim; ++axis) {
    const int factor = fine.factors[axis];
    const int end = (own.start[axis] + own.size[axis] + factor - 1) / factor;
    own.start[axis] /= factor;
    own.size[axis] = end - own.start[axis];
    coarse.elements[axis] = (fine.elements[axis] + factor - 1) / factor;
    coarse.spacing[axis] = fine.spacing[axis] * factor;
  }
  const auto active_in = [&](const IndexBox<Dim>& box) {
    std::vector<char> active(static_cast<std::size_t>(box.count()), 0);
    fine.mesh.element_box().for_each([&](Index<Dim> element, std::int64_t) {
      if (fine.mesh.element_number(element) < 0) return;
      for (int axis = 0; axis < Dim; ++axis) element[axis] /= fine.factors[axis];
      active[box.offset(element)] = 1;
    });
    return active;
  };
  const std::vector<char> active = active_in(own);
  const std::int64_t count = std::count(active.begin(), active.end(), 1);
  coarse.distributed = keep_distributed(fine, fine.distributed ? sum(grid_.comm(), count) : count);
  if (coarse.distributed) {
    coarse.mesh = LaneMesh<Dim>(own, active);
    return;
  }
  const IndexBox<Dim> whole{Index<Dim>{}, coarse.elements};
  std::vector<char> all = active_in(whole);
  if (fine.distributed)
    MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_CHAR, MPI_MAX, grid_.comm());
  coarse.mesh = LaneMesh<Dim>(whole, all);
}

/// A coarse unknown is held where the fine one at its place is; where there is none, because the grid is
/// padded there, if one that it interpolates to is held. What is held between coarse nodes of which none is
/// held then would be lost: those are held, too. Should that still leave a rigid motion free, as of a strip
/// of nodes that has become a line, whatever interpolates to something held.
template <int Dim>
void LaneHierarchy<Dim>::find_fixed(const LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse) {
  constexpr int flags = 3;  // a fine node at the same place, that one held, one held nearby
  const std::size_t unknowns = static_cast<std::size_t>(coarse.mesh.nodes()) * components_;
  const auto sum_marks = [&](std::vector<double>& marks, int entries) {
    if (coarse.distributed)
      sum_over_holders(coarse, marks.data(), components_ * entries);
    else if (fine.distributed)
      sum_in_place(grid_.comm(), marks);
  };
  const auto is_held = [&](std::int64_t node, int a) {
    return std::binary_search(fine.fixed.begin(), fine.fixed.end(), node * components_ + a);
  };

  std::vector<double> marks(unknowns * flags, 0.0);
  for_each_node(fine, coarse.mesh, [&](const std::vector<std::int64_t>& sources, std::int64_t node) {
    for (int a = 0; a < components_; ++a)
      for (const std::int64_t source : sources) {
        double* mark = &marks[(source * components_ + a) * flags];
        const bool same_place = sources.size() == 1, held = is_held(node, a);
        if (same_place) mark[0] = 1.0;
        if (same_place && held) mark[1] = 1.0;
        if (held) mark[2] = 1.0;
      }
  });
  sum_marks(marks, flags);
  std::vector<double> held(unknowns), lost(unknowns, 0.0);
  for (std::size_t unknown = 0; unknown < unknowns; ++unknown) {
    const double* mark = &marks[unknown * flags];
    held[unknown] = (mark[0] > 0.0 ? mark[1] : mark[2]) > 0.0 ? 1.0 : 0.0;
  }
  for_each_node(fine, coarse.mesh, [&](const std::vector<std::int64_t>& sources, std::int64_t node) {
    for (int a = 0; a < components_; ++a) {
      const auto place = [&](std::int64_t source) { return source * components_ + a; };
      const bool is_lost = is_held(node, a) && std::none_of(sources.begin(), sources.end(), [&](auto source) {
                             return held[place(source)] > 0.0;
                           });
      for (std::size_t i = 0; is_lost && i < sources.size(); ++i) lost[place(sources[i])] = 1.0;
    }
  });
  sum_marks(lost, 1);
  const auto collect = [&](bool all_nearby) {
    coarse.fixed.clear();
    for (std::size_t unknown = 0; unknown < unknowns; ++unknown)
      if (held[unknown] > 0.0 || lost[unknown] > 0.0 || (all_nearby && marks[unknown * flags + 2] > 0.0))
        coarse.fixed.push_back(static_cast<std::int64_t>(unknown));
  };
  collect(false);
  if (!holds_rigid_motions(coarse)) collect(true);
}

/// Whether what is held of a level, for elasticity, leaves no rigid motion.
template <int Dim>
bool LaneHierarchy<Dim>::holds_rigid_motions(const LaneLevel<Dim>& level) const {
  constexpr double rounding = 1e-9;
  if (components_ != Dim) return true;
  const std::vector<Point<Dim>> positions = level.node_positions();
  RigidFit<Dim> fit;
  for (const std::int64_t unknown : level.fixed)
    fit.add(positions[unknown / Dim], static_cast<int>(unknown % Dim));
  if (level.distributed)
    fit.sum(level.comm);  // shared nodes count more than once, which does not matter here
  return fit.factor(rounding);
}

FABSEQ_INSTANTIATE_STRUCT(LaneLevel);
template void sum_over_holders(LaneLevel<2>&, double*, int);
template void sum_over_holders(LaneLevel<3>&, double*, int);
template void sum_over_holders(LaneLevel<2>&, float*, int);
template void sum_over_holders(LaneLevel<3>&, float*, int);
FABSEQ_INSTANTIATE_CLASS(LaneHierarchy);

}  // namespace fabseq
