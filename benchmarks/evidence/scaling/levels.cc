// SPDX-License-Identifier: MIT
#include "evidence/scaling/levels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace scaling {

namespace {

using fabseq::Index;
using fabseq::LaneMesh;
using Decomposition = fabseq::Decomposition<3>;
using Hierarchy = fabseq::LaneHierarchy<3>;
using Shares = fabseq::LevelShares<3>;

double count_of(const Index<3>& box) { return static_cast<double>(fabseq::IndexBox<3>{{}, box}.count()); }

/// Nodes of so many elements, where no more is known.
double nodes_of(double elements) {
  return elements > 0.0 ? std::pow(std::pow(elements, 1.0 / 3.0) + 1.0, 3) : 0.0;
}

/// Mesh of a process, where the level's elements are known.
LaneMesh<3> mesh_of(const LaneMesh<3>& whole, const Shares& shares, int process) {
  const auto box = shares.elements_of(process);
  std::vector<char> active(static_cast<std::size_t>(box.count()));
  box.for_each([&](const Index<3>& element, std::int64_t offset) {
    active[offset] = whole.element_number(element) >= 0 ? 1 : 0;
  });
  return {box, active};
}

/// Makes the meshes of all ranks and looks for nodes that several of them hold.
void deal_out(Level& level, const Shares& shares) {
  const auto ranks = static_cast<std::size_t>(shares.count());
  std::vector<std::vector<std::size_t>> holders(static_cast<std::size_t>(level.mesh->nodes()));
  level.own_elements = level.own_nodes = 0.0;
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    const LaneMesh<3> mesh = mesh_of(*level.mesh, shares, static_cast<int>(rank));
    level.own_elements = std::max(level.own_elements, static_cast<double>(mesh.elements()));
    level.own_nodes = std::max(level.own_nodes, static_cast<double>(mesh.nodes()));
    for (const auto& run : mesh.node_runs())
      for (int i = 0; i < run.length; ++i)
        holders[level.mesh->node_number({run.index[0] + i, run.index[1], run.index[2]})].push_back(rank);
  }
  std::vector<std::set<std::size_t>> neighbors(ranks);
  std::vector<double> sent(ranks, 0.0);
  for (const auto& of_node : holders)
    for (const std::size_t rank : of_node) {
      sent[rank] += static_cast<double>(of_node.size() - 1);
      for (const std::size_t other : of_node)
        if (other != rank) neighbors[rank].insert(other);
    }
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    const auto messages = static_cast<double>(neighbors[rank].size());
    level.halo_messages += messages;
    level.halo_nodes += sent[rank];
    level.own_neighbors = std::max(level.own_neighbors, messages);
    level.own_halo_nodes = std::max(level.own_halo_nodes, sent[rank]);
  }
}

/// The same where only the filled share of the box is known: the part fills it evenly, and a rank's share of
/// it is a compact one.
void estimate(Level& level, const Index<3>& processes) {
  const double ranks = count_of(processes);
  double nodes = 1.0, with_halo = 1.0, squares = 1.0, holders = 1.0, pairs = 1.0, around = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double count = processes[axis], extent = level.box[axis], sides = std::min(count - 1.0, 2.0);
    const double edge = level.fill == 1.0 ? extent / count : std::pow(level.elements / ranks, 1.0 / 3.0);
    nodes *= edge + 1.0;
    with_halo *= edge + 1.0 + sides;
    // A node with h holders is sent h (h - 1) times; h is a product over the axes.
    squares *= extent + 1.0 + 3.0 * (count - 1.0);
    holders *= extent + count;
    pairs *= 3.0 * count - 2.0;
    around *= 1.0 + sides;
  }
  level.own_elements = level.elements / ranks;
  level.own_nodes = nodes;
  level.halo_messages = pairs - ranks;
  level.halo_nodes = (squares - holders) * level.fill;
  level.own_neighbors = around - 1.0;
  level.own_halo_nodes = with_halo - nodes;
}

/// Adds up what processes of one level send to those of the next.
struct GatherCount {
  explicit GatherCount(const Shares& coarse) : holders(coarse.ranks), received(holders.size()) {}
  void add(int from_rank, int process, double entries) {
    if (entries <= 0.0 || holders[process] == from_rank) return;
    auto& [messages, sum, own_messages, own_entries] = received[process];
    ++own_messages;
    own_entries += entries;
    ++all.messages;
    all.entries += entries;
    all.own_messages = std::max(all.own_messages, own_messages);
    all.own_entries = std::max(all.own_entries, own_entries);
  }

  const std::vector<int>& holders;
  std::vector<Gather> received;
  Gather all{};
};

LaneMesh<3> stage_of(const Level& fine, const Shares& shares, int process) {
  return Hierarchy::stage_of(mesh_of(*fine.mesh, shares, process),
                             shares.elements_of(process).coarsened(fine.factors), fine.factors);
}

void hold(Level& level, const Shares& shares) {
  level.ranks = shares.count();
  if (level.mesh != nullptr)
    deal_out(level, shares);
  else
    estimate(level, shares.ranges.processes);
}

void gather(Level& level, const Level& fine, const Shares& shares, const Shares& coarse) {
  GatherCount nodes(coarse), elements(coarse);
  for (int process = 0; process < shares.count(); ++process) {
    std::map<int, double> of_elements, of_nodes;
    if (fine.mesh != nullptr) {
      const LaneMesh<3> stage = stage_of(fine, shares, process);
      stage.element_box().for_each([&](const Index<3>& element, std::int64_t) {
        if (stage.element_number(element) >= 0) ++of_elements[coarse.holder_of(element)];
      });
      if (stage.elements() > 0)
        for (const int holder : fabseq::LevelGather<3>::holders_of_nodes(stage, coarse)) ++of_nodes[holder];
    } else {
      const auto parents = shares.elements_of(process).coarsened(fine.factors);
      const Index<3> low = coarse.ranges.position_of_element(parents.start);
      const Index<3> high = coarse.ranges.position_of_element(parents.index(parents.count() - 1));
      const fabseq::IndexBox<3> touched{low,
                                        {high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1}};
      touched.for_each([&](const Index<3>& position, std::int64_t) {
        const auto box = coarse.ranges.elements_of(position);
        const auto common = static_cast<double>(box.common_with(parents).count());
        of_elements[coarse.ranges.rank_at(position)] = fine.fill * common;
        of_nodes[coarse.ranges.rank_at(position)] = nodes_of(fine.fill * common);
      });
    }
    for (const auto& [holder, count] : of_elements) elements.add(shares.ranks[process], holder, count);
    for (const auto& [holder, count] : of_nodes) nodes.add(shares.ranks[process], holder, count);
  }
  level.gathered_nodes = nodes.all;
  level.gathered_elements = elements.all;
}

void deal_lanes(Level& level, const Level& fine, const Shares& shares) {
  level.own_nodes = 0.0;
  for (int process = 0; process < shares.count(); ++process) {
    const auto parents = shares.elements_of(process).coarsened(fine.factors);
    const auto nodes = fine.mesh != nullptr
                           ? stage_of(fine, shares, process).nodes()
                           : std::llround(nodes_of(fine.fill * static_cast<double>(parents.count())));
    if (nodes > 0) level.holders.emplace_back(shares.ranks[process], nodes);
    level.own_nodes = std::max(level.own_nodes, static_cast<double>(nodes));
  }
}

}  // namespace

std::vector<Level> whole_levels(const Hierarchy& hierarchy) {
  std::vector<Level> whole;
  for (int index = 0; index < hierarchy.count(); ++index) {
    const auto& level = hierarchy.level(index);
    whole.push_back({.box = level.elements,
                     .factors = level.factors,
                     .mesh = &level.mesh,
                     .elements = static_cast<double>(level.mesh.elements()),
                     .nodes = static_cast<double>(level.mesh.nodes())});
  }
  return whole;
}

std::vector<Level> whole_levels(Index<3> box, double fill, int components) {
  std::vector<Level> whole;
  const bool full = fill == 1.0;
  double elements = fill * count_of(box);
  for (Index<3> factors{}; factors != Index<3>{1, 1, 1};) {
    factors = Hierarchy::choose_factors(box, {1.0, 1.0, 1.0}, std::llround(elements), components);
    const double nodes = full ? count_of({box[0] + 1, box[1] + 1, box[2] + 1}) : nodes_of(elements);
    whole.push_back({.box = box, .factors = factors, .fill = fill, .elements = elements, .nodes = nodes});
    for (int& extent : box) extent = (extent + 1) / 2;
    elements = full ? count_of(box) : elements / 8.0;
  }
  return whole;
}

std::vector<Level> levels_on(const std::vector<Level>& whole, const Decomposition& ranges) {
  Shares shares = Shares::finest(ranges);
  if (shares.count() == 1) return whole;
  std::vector<Level> levels{whole.front()};
  hold(levels.back(), shares);
  const std::size_t count = std::max<std::size_t>(2, whole.size());  // a small finest level has a copy
  for (std::size_t index = 1; index < count; ++index) {
    const Level& fine = levels.back();
    Shares coarse = shares.coarsened(fine.factors, std::llround(fine.elements));
    Level level = whole[std::min(index, whole.size() - 1)];
    level.lanes_dealt = index + 1 == count;
    if (level.lanes_dealt)
      deal_lanes(level, fine, shares);
    else if (!shares.stay_in_place(coarse, fine.factors))
      gather(level, fine, shares, coarse);
    if (!level.lanes_dealt) hold(level, coarse);
    shares = std::move(coarse);
    levels.push_back(level);
  }
  return levels;
}

}  // namespace scaling
