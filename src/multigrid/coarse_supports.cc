// SPDX-License-Identifier: MIT
#include "fabseq/base/mpi.h"
#include "fabseq/grid/rigid_fit.h"
#include "multigrid/lane_hierarchy.h"

#include <algorithm>
#include <vector>

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

/// Sums over a level of what ranks have on its parts: the stage, or the mesh itself.
template <int Dim>
std::vector<double> sum_parts(MPI_Comm comm, LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse,
                              const std::vector<double>& parts, int entries) {
  std::vector<double> sums(static_cast<std::size_t>(coarse.mesh.nodes()) * entries, 0.0);
  if (coarse.lanes_dealt) {
    for (std::size_t node = 0; node < fine.dealt.size(); ++node)
      std::copy_n(&parts[node * entries], entries, &sums[fine.dealt[node] * entries]);
    sum_in_place(comm, sums);
    return sums;
  }
  if (fine.staged)
    fine.gather.add_nodes(parts.data(), sums.data(), entries);
  else
    sums = parts;
  sum_over_holders(coarse, sums.data(), entries);
  return sums;
}

/// Values of a level on its parts.
template <int Dim>
std::vector<double> on_parts(LaneLevel<Dim>& fine, const LaneLevel<Dim>& coarse,
                             const std::vector<double>& values, int entries) {
  if (!fine.staged) return values;
  std::vector<double> parts(static_cast<std::size_t>(fine.stage.nodes()) * entries);
  if (coarse.lanes_dealt) {
    for (std::size_t node = 0; node < fine.dealt.size(); ++node)
      std::copy_n(&values[fine.dealt[node] * entries], entries, &parts[node * entries]);
  } else {
    fine.gather.fetch_nodes(values.data(), parts.data(), entries);
  }
  return parts;
}

/// Whether what is held of a level, for elasticity, leaves no rigid motion.
template <int Dim>
bool holds_rigid_motions(const LaneLevel<Dim>& level, int components) {
  constexpr double rounding = 1e-9;
  if (components != Dim) return true;
  const std::vector<Point<Dim>> positions = level.node_positions();
  RigidFit<Dim> fit;
  for (const std::int64_t unknown : level.fixed)
    fit.add(positions[unknown / Dim], static_cast<int>(unknown % Dim));
  if (level.distributed)
    fit.sum(level.comm);  // shared nodes count more than once, which does not matter here
  return fit.factor(rounding);
}

}  // namespace

/// A coarse unknown is held where the fine one at its place is; where there is none, because the grid is
/// padded there, if one that it interpolates to is held. What is held between coarse nodes of which none is
/// held then would be lost: those are held, too. Should that still leave a rigid motion free, as of a strip
/// of nodes that has become a line, whatever interpolates to something held.
template <int Dim>
void find_coarse_supports(MPI_Comm comm, LaneLevel<Dim>& fine, LaneLevel<Dim>& coarse, int components) {
  constexpr int flags = 3;  // a fine node at the same place, that one held, one held nearby
  const LaneMesh<Dim>& part_mesh = fine.staged ? fine.stage : coarse.mesh;
  const std::size_t parts = static_cast<std::size_t>(part_mesh.nodes()) * components;
  const std::size_t unknowns = static_cast<std::size_t>(coarse.mesh.nodes()) * components;
  const auto is_held = [&](std::int64_t node, int a) {
    return std::binary_search(fine.fixed.begin(), fine.fixed.end(), node * components + a);
  };

  std::vector<double> marks(parts * flags, 0.0);
  for_each_node(fine, part_mesh, [&](const std::vector<std::int64_t>& sources, std::int64_t node) {
    for (int a = 0; a < components; ++a)
      for (const std::int64_t source : sources) {
        double* mark = &marks[(source * components + a) * flags];
        const bool same_place = sources.size() == 1, held = is_held(node, a);
        if (same_place) mark[0] = 1.0;
        if (same_place && held) mark[1] = 1.0;
        if (held) mark[2] = 1.0;
      }
  });
  marks = sum_parts(comm, fine, coarse, marks, components * flags);
  std::vector<double> held(unknowns), lost(parts, 0.0);
  for (std::size_t unknown = 0; unknown < unknowns; ++unknown) {
    const double* mark = &marks[unknown * flags];
    held[unknown] = (mark[0] > 0.0 ? mark[1] : mark[2]) > 0.0 ? 1.0 : 0.0;
  }
  const std::vector<double> held_nearby = on_parts(fine, coarse, held, components);
  for_each_node(fine, part_mesh, [&](const std::vector<std::int64_t>& sources, std::int64_t node) {
    for (int a = 0; a < components; ++a) {
      const auto place = [&](std::int64_t source) { return source * components + a; };
      const bool is_lost = is_held(node, a) && std::none_of(sources.begin(), sources.end(), [&](auto source) {
                             return held_nearby[place(source)] > 0.0;
                           });
      for (std::size_t i = 0; is_lost && i < sources.size(); ++i) lost[place(sources[i])] = 1.0;
    }
  });
  lost = sum_parts(comm, fine, coarse, lost, components);
  const auto collect = [&](bool all_nearby) {
    coarse.fixed.clear();
    for (std::size_t unknown = 0; unknown < unknowns; ++unknown)
      if (held[unknown] > 0.0 || lost[unknown] > 0.0 || (all_nearby && marks[unknown * flags + 2] > 0.0))
        coarse.fixed.push_back(static_cast<std::int64_t>(unknown));
  };
  collect(false);
  if (!holds_rigid_motions(coarse, components)) collect(true);
}

FABSEQ_INSTANTIATE_FUNCTION(find_coarse_supports);

}  // namespace fabseq
