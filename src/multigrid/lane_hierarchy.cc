// SPDX-License-Identifier: MIT
#include "multigrid/lane_hierarchy.h"

#include "fabseq/base/mpi.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace fabseq {

namespace {

/// Whether these are the factors of a level that no other follows.
template <std::size_t Dim>
bool is_last(const std::array<int, Dim>& factors) {
  return *std::max_element(factors.begin(), factors.end()) == 1;
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
  if (!level.distributed) return;
  const auto& nodes = level.shared.nodes();
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
  finest.shares = LevelShares<Dim>::finest(grid_.decomposition());
  active_ = sum(grid_.comm(), finest.mesh.elements());
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
  const int process = level.shares.process_of(rank_of(grid_.comm()));
  level.distributed = level.shares.count() > 1 && process >= 0;
  MPI_Comm comm = grid_.comm();
  if (level.shares.count() > 1 && level.shares.count() < size_of(comm))
    comm = comms_.emplace_back(comm, process >= 0 ? 0 : MPI_UNDEFINED, process);
  if (level.distributed) {
    level.comm = comm;
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
                                              std::int64_t active, int components) {
  Index<Dim> factors;
  factors.fill(1);
  if (active <= coarsest_elements(components)) return factors;
  double shortest = std::numeric_limits<double>::max();
  for (int axis = 0; axis < Dim; ++axis)
    if (elements[axis] > 1) shortest = std::min(shortest, spacing[axis]);
  for (int axis = 0; axis < Dim; ++axis)
    if (elements[axis] > 1 && spacing[axis] < 1.5 * shortest) factors[axis] = 2;
  return factors;
}

template <int Dim>
bool LaneHierarchy<Dim>::coarsen() {
  LaneLevel<Dim>& fine = levels_.back();
  fine.factors = choose_factors(fine.elements, fine.spacing, active_, components_);
  // Several ranks deal the lanes of the last level out: it is a copy of the finest if that is small enough.
  if (is_last(fine.factors) && (fine.lanes_dealt || size_of(grid_.comm()) == 1)) return false;
  LaneLevel<Dim>& coarse = levels_.emplace_back();
  make_coarse_mesh(fine, coarse);
  set_up_sums(coarse);
  const LaneMesh<Dim>& parts = fine.staged ? fine.stage : coarse.mesh;
  fine.transfer = LaneTransfer<Dim>(fine.mesh, parts, fine.factors);
  // Coefficients of the last level are summed on its whole mesh.
  const LaneMesh<Dim>& parents = coarse.lanes_dealt ? coarse.mesh : parts;
  fine.parent.resize(static_cast<std::size_t>(fine.mesh.elements()));
  fine.mesh.element_box().for_each([&](Index<Dim> element, std::int64_t) {
    const int number = fine.mesh.element_number(element);
    if (number < 0) return;
    for (int axis = 0; axis < Dim; ++axis) element[axis] /= fine.factors[axis];
    fine.parent[number] = parents.element_number(element);
  });
  find_coarse_supports(grid_.comm(), fine, coarse, components_);
  return true;
}

template <int Dim>
LaneMesh<Dim> LaneHierarchy<Dim>::stage_of(const LaneMesh<Dim>& fine, const IndexBox<Dim>& parents,
                                           const Index<Dim>& factors) {
  std::vector<char> active(static_cast<std::size_t>(parents.count()), 0);
  fine.element_box().for_each([&](Index<Dim> element, std::int64_t) {
    if (fine.element_number(element) < 0) return;
    for (int axis = 0; axis < Dim; ++axis) element[axis] /= factors[axis];
    active[parents.offset(element)] = 1;
  });
  return LaneMesh<Dim>(parents, active);
}

template <int Dim>
void LaneHierarchy<Dim>::make_coarse_mesh(LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse) {
  const MPI_Comm comm = grid_.comm();
  for (int axis = 0; axis < Dim; ++axis) {
    coarse.elements[axis] = (fine.elements[axis] + fine.factors[axis] - 1) / fine.factors[axis];
    coarse.spacing[axis] = fine.spacing[axis] * fine.factors[axis];
  }
  LaneMesh<Dim> stage;
  if (const int process = fine.shares.process_of(rank_of(comm)); process >= 0)
    stage = stage_of(fine.mesh, fine.shares.elements_of(process).coarsened(fine.factors), fine.factors);
  coarse.shares = fine.shares.coarsened(fine.factors, active_);
  fine.staged = !fine.shares.stay_in_place(coarse.shares, fine.factors);
  if (fine.staged) {
    fine.gather = LevelGather<Dim>(comm, stage, coarse.shares);
    coarse.mesh = fine.gather.mesh();
    fine.stage = std::move(stage);
  } else {
    coarse.mesh = std::move(stage);
  }
  active_ = sum(comm, coarse.mesh.elements());
  if (size_of(comm) > 1 && is_last(choose_factors(coarse.elements, coarse.spacing, active_, components_)))
    deal_lanes_out(fine, coarse);
}

/// Makes the last level's mesh whole on all ranks.
template <int Dim>
void LaneHierarchy<Dim>::deal_lanes_out(LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse) {
  if (!fine.staged) fine.stage = std::move(coarse.mesh);
  fine.staged = true;
  fine.gather = {};
  coarse.lanes_dealt = true;
  coarse.shares = {};
  const IndexBox<Dim> whole{Index<Dim>{}, coarse.elements};
  std::vector<char> active(static_cast<std::size_t>(whole.count()), 0);
  fine.stage.element_box().for_each([&](const Index<Dim>& element, std::int64_t) {
    if (fine.stage.element_number(element) >= 0) active[whole.offset(element)] = 1;
  });
  MPI_Allreduce(MPI_IN_PLACE, active.data(), static_cast<int>(active.size()), MPI_BYTE, MPI_BOR,
                grid_.comm());
  coarse.mesh = LaneMesh<Dim>(whole, active);
  fine.dealt.resize(static_cast<std::size_t>(fine.stage.nodes()));
  fine.stage.node_box().for_each([&](const Index<Dim>& node, std::int64_t) {
    const int number = fine.stage.node_number(node);
    if (number >= 0) fine.dealt[number] = coarse.mesh.node_number(node);
  });
  deal_ = LaneDeal(grid_.comm(), fine.dealt);
}

FABSEQ_INSTANTIATE_STRUCT(LaneLevel);
template void sum_over_holders(LaneLevel<2>&, double*, int);
template void sum_over_holders(LaneLevel<3>&, double*, int);
template void sum_over_holders(LaneLevel<2>&, float*, int);
template void sum_over_holders(LaneLevel<3>&, float*, int);
FABSEQ_INSTANTIATE_CLASS(LaneHierarchy);

}  // namespace fabseq
