#include "fabseq/solve/lane_hierarchy.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fabseq {

template <int Dim, class Real>
void sum_over_holders(LaneLevel<Dim>& level, Real* values, int block) {
  const auto& nodes = level.shared.nodes();
  if (!level.distributed) return;
  std::vector<Real> packed(nodes.size() * block);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    std::copy_n(values + nodes[i] * block, block, &packed[i * block]);
  level.shared.sum(std::span(packed), block);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    std::copy_n(&packed[i * block], block, values + nodes[i] * block);
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
std::int64_t LaneHierarchy<Dim>::total_elements(const LaneLevel<Dim>& level) const {
  const std::int64_t own = level.mesh.elements();
  return level.distributed ? sum(grid_.comm(), own) : own;
}

template <int Dim>
Index<Dim> LaneHierarchy<Dim>::choose_factors(const LaneLevel<Dim>& fine) const {
  double shortest = std::numeric_limits<double>::max();
  for (int axis = 0; axis < Dim; ++axis)
    if (fine.elements[axis] > 1) shortest = std::min(shortest, fine.spacing[axis]);
  Index<Dim> factors;
  for (int axis = 0; axis < Dim; ++axis)
    factors[axis] = fine.elements[axis] > 1 && fine.spacing[axis] < 1.5 * shortest ? 2 : 1;
  return factors;
}

/// Distributed levels need every rank's first element on the coarse grid, and enough to do.
template <int Dim>
bool LaneHierarchy<Dim>::keep_distributed(const LaneLevel<Dim>& fine, std::int64_t coarse_elements) const {
  const MPI_Comm comm = grid_.comm();
  if (!fine.distributed || coarse_elements < agglomeration_limit * size_of(comm)) return false;
  bool aligned = true;
  for (int axis = 0; axis < Dim; ++axis)
    aligned = aligned && fine.mesh.element_box().start[axis] % fine.factors[axis] == 0;
  return !any(comm, !aligned);
}

template <int Dim>
bool LaneHierarchy<Dim>::coarsen() {
  LaneLevel<Dim>& fine = levels_.back();
  fine.factors = choose_factors(fine);
  if (total_elements(fine) <= coarsest_elements ||
      *std::max_element(fine.factors.begin(), fine.factors.end()) == 1) {
    if (!fine.distributed) return false;
    fine.factors.fill(1);  // the last level is whole on every rank: a copy of this one
  }
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
/// padded there, if one that it interpolates to is held.
template <int Dim>
void LaneHierarchy<Dim>::find_fixed(const LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse) {
  constexpr int flags = 3;  // a fine node at the same place, that one held, one held nearby
  const int block = components_ * flags;
  std::vector<double> marks(static_cast<std::size_t>(coarse.mesh.nodes()) * block, 0.0);
  const auto visit = [&](const Index<Dim>& node, std::int64_t number) {
    Index<Dim> below{}, span{};
    bool same_place = true;
    for (int axis = 0; axis < Dim; ++axis) {
      below[axis] = node[axis] / fine.factors[axis];
      span[axis] = 1 + (node[axis] % fine.factors[axis] != 0 ? 1 : 0);
      same_place = same_place && span[axis] == 1;
    }
    for (int a = 0; a < components_; ++a) {
      const bool held = std::binary_search(fine.fixed.begin(), fine.fixed.end(), number * components_ + a);
      IndexBox<Dim>{below, span}.for_each([&](const Index<Dim>& neighbor, std::int64_t) {
        double* mark =
            &marks[static_cast<std::size_t>(coarse.mesh.node_number(neighbor)) * block + a * flags];
        if (same_place) mark[0] = 1.0;
        if (same_place && held) mark[1] = 1.0;
        if (held) mark[2] = 1.0;
      });
    }
  };
  fine.mesh.node_box().for_each([&](const Index<Dim>& node, std::int64_t) {
    const std::int64_t number = fine.mesh.node_number(node);
    if (number >= 0) visit(node, number);
  });
  if (coarse.distributed) {
    sum_over_holders(coarse, marks.data(), block);
  } else if (fine.distributed) {
    sum_in_place(grid_.comm(), marks);
  }
  const auto collect = [&](bool only_same_place) {
    for (std::int64_t unknown = 0; unknown < coarse.mesh.nodes() * components_; ++unknown) {
      const double* mark = &marks[unknown * flags];
      const bool by_place = only_same_place && mark[0] > 0.0;
      if ((by_place ? mark[1] : mark[2]) > 0.0) coarse.fixed.push_back(unknown);
    }
    const auto count = static_cast<std::int64_t>(coarse.fixed.size());
    return (coarse.distributed ? sum(grid_.comm(), count) : count) > 0;
  };
  // Supports between the coarse nodes must not be lost altogether.
  if (!collect(true)) collect(false);
}

template void sum_over_holders(LaneLevel<2>&, double*, int);
template void sum_over_holders(LaneLevel<3>&, double*, int);
template void sum_over_holders(LaneLevel<2>&, float*, int);
template void sum_over_holders(LaneLevel<3>&, float*, int);
template class LaneHierarchy<2>;
template class LaneHierarchy<3>;

}  // namespace fabseq
