// SPDX-License-Identifier: MIT
#include "fabseq/lanes/level_gather.h"

#include "fabseq/base/mpi.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Box of all elements of a level, or `longer` along each axis: 1 for a box of its nodes.
template <int Dim>
IndexBox<Dim> whole_box(const LevelShares<Dim>& shares, int longer) {
  IndexBox<Dim> box;
  for (int axis = 0; axis < Dim; ++axis) box.size[axis] = shares.ranges.range_starts[axis].back() + longer;
  return box;
}

}  // namespace

template <int Dim>
LevelGather<Dim>::LevelGather(MPI_Comm comm, const LaneMesh<Dim>& stage, const LevelShares<Dim>& fine,
                              const Index<Dim>& factors, const LevelShares<Dim>& coarse)
    : comm_(comm) {
  // Who may have something for whom follows from the shares.
  const int fine_process = fine.process_of(rank_of(comm)), coarse_process = coarse.process_of(rank_of(comm));
  const auto meet = [&](int of_fine, int of_coarse) {
    const auto parents = fine.elements_of(of_fine).coarsened(factors);
    return parents.common_with(coarse.elements_of(of_coarse)).count() > 0;
  };
  Places elements, nodes, elements_here, nodes_here;
  for (int process = 0; fine_process >= 0 && process < coarse.count(); ++process)
    if (meet(fine_process, process)) elements.push_back({coarse.ranks[process], {}});
  for (int process = 0; coarse_process >= 0 && process < fine.count(); ++process)
    if (meet(process, coarse_process)) elements_here.push_back({fine.ranks[process], {}});
  nodes = elements;
  nodes_here = elements_here;
  deal_out(stage, coarse, elements, nodes);
  const auto collect = [](std::vector<Peer>& peers, const Places& places, auto&& number) {
    for (const auto& message : places) {
      if (message.values.empty()) continue;
      Peer& peer = peers.emplace_back();
      peer.rank = message.rank;
      for (const std::int64_t place : message.values) peer.numbers.push_back(number(place));
    }
  };
  const IndexBox<Dim> all = whole_box(coarse, 0), all_nodes = whole_box(coarse, 1);
  collect(elements_.stage, elements,
          [&](std::int64_t place) { return stage.element_number(all.index(place)); });
  collect(nodes_.stage, nodes, [&](std::int64_t place) { return stage.node_number(all_nodes.index(place)); });
  exchange_unsized(comm, elements, elements_here);
  exchange_unsized(comm, nodes, nodes_here);

  if (coarse_process >= 0) {
    const IndexBox<Dim> box = coarse.elements_of(coarse_process);
    std::vector<char> active(static_cast<std::size_t>(box.count()), 0);
    for (const auto& message : elements_here)
      for (const std::int64_t place : message.values) active[box.offset(all.index(place))] = 1;
    mesh_ = LaneMesh<Dim>(box, active);
  }
  collect(elements_.coarse, elements_here,
          [&](std::int64_t place) { return mesh_.element_number(all.index(place)); });
  collect(nodes_.coarse, nodes_here,
          [&](std::int64_t place) { return mesh_.node_number(all_nodes.index(place)); });
}

/// A node goes to the rank that holds the middle of the stage, if that has one of the stage's elements next
/// to the node, else to the first that does: such a rank has the node, whatever elements others have.
template <int Dim>
std::vector<int> LevelGather<Dim>::holders_of_nodes(const LaneMesh<Dim>& stage,
                                                    const LevelShares<Dim>& coarse) {
  std::vector<int> holders(static_cast<std::size_t>(stage.nodes()), coarse.count());
  if (stage.elements() == 0) return holders;
  Index<Dim> middle = stage.element_box().start;
  for (int axis = 0; axis < Dim; ++axis) middle[axis] += stage.element_box().size[axis] / 2;
  const int home = coarse.holder_of(middle);
  stage.element_box().for_each([&](const Index<Dim>& element, std::int64_t) {
    if (stage.element_number(element) < 0) return;
    const int holder = coarse.holder_of(element);
    for (int corner = 0; corner < corner_count<Dim>; ++corner) {
      Index<Dim> node = element;
      for (int axis = 0; axis < Dim; ++axis) node[axis] += (corner >> axis) & 1;
      int& chosen = holders[stage.node_number(node)];
      if (chosen != home) chosen = holder == home ? home : std::min(chosen, holder);
    }
  });
  return holders;
}

template <int Dim>
void LevelGather<Dim>::deal_out(const LaneMesh<Dim>& stage, const LevelShares<Dim>& coarse, Places& elements,
                                Places& nodes) {
  const IndexBox<Dim> all = whole_box(coarse, 0), all_nodes = whole_box(coarse, 1);
  const std::vector<int> holders = holders_of_nodes(stage, coarse);
  const auto of_process = [&](Places& places, int process) -> std::vector<std::int64_t>& {
    return std::find_if(places.begin(), places.end(),
                        [&](const auto& message) { return message.rank == coarse.ranks[process]; })
        ->values;
  };
  stage.element_box().for_each([&](const Index<Dim>& element, std::int64_t) {
    if (stage.element_number(element) >= 0)
      of_process(elements, coarse.holder_of(element)).push_back(all.offset(element));
  });
  stage.node_box().for_each([&](const Index<Dim>& node, std::int64_t) {
    const int number = stage.node_number(node);
    if (number >= 0) of_process(nodes, holders[number]).push_back(all_nodes.offset(node));
  });
}

/// Fills buffers from `from`, makes room for what comes to `to`, and exchanges them.
template <int Dim>
template <class Real>
typename LevelGather<Dim>::template Buffers<Real>& LevelGather<Dim>::pack(const std::vector<Peer>& from,
                                                                          const std::vector<Peer>& to,
                                                                          const Real* values, int entries) {
  auto& buffers = std::get<Buffers<Real>>(buffers_);
  const auto size_for = [entries](std::vector<PeerMessage<Real>>& messages, const std::vector<Peer>& peers) {
    messages.resize(peers.size());
    for (std::size_t i = 0; i < peers.size(); ++i) {
      messages[i].rank = peers[i].rank;
      messages[i].values.resize(peers[i].numbers.size() * entries);
    }
  };
  size_for(buffers.outgoing, from);
  size_for(buffers.incoming, to);
  for (std::size_t i = 0; i < from.size(); ++i) {
    Real* place = buffers.outgoing[i].values.data();
    for (const std::int64_t number : from[i].numbers)
      place = std::copy_n(values + number * entries, entries, place);
  }
  exchange(comm_, buffers.outgoing, buffers.incoming);
  return buffers;
}

template <int Dim>
template <class Real>
void LevelGather<Dim>::add(const Route& route, const Real* stage, Real* coarse, int entries) {
  const auto& buffers = pack(route.stage, route.coarse, stage, entries);
  for (std::size_t i = 0; i < route.coarse.size(); ++i) {
    const Real* value = buffers.incoming[i].values.data();
    for (const std::int64_t number : route.coarse[i].numbers)
      for (int entry = 0; entry < entries; ++entry) coarse[number * entries + entry] += *value++;
  }
}

template <int Dim>
template <class Real>
void LevelGather<Dim>::add_nodes(const Real* stage, Real* coarse, int entries) {
  add(nodes_, stage, coarse, entries);
}

template <int Dim>
template <class Real>
void LevelGather<Dim>::add_elements(const Real* stage, Real* coarse, int entries) {
  add(elements_, stage, coarse, entries);
}

template <int Dim>
template <class Real>
void LevelGather<Dim>::fetch_nodes(const Real* coarse, Real* stage, int entries) {
  const auto& buffers = pack(nodes_.coarse, nodes_.stage, coarse, entries);
  for (std::size_t i = 0; i < nodes_.stage.size(); ++i) {
    const Real* value = buffers.incoming[i].values.data();
    for (const std::int64_t number : nodes_.stage[i].numbers) {
      std::copy_n(value, entries, stage + number * entries);
      value += entries;
    }
  }
}

FABSEQ_INSTANTIATE_CLASS(LevelGather);
#define FABSEQ_INSTANTIATE_GATHER(Dim, Real)                             \
  template void LevelGather<Dim>::add_nodes(const Real*, Real*, int);    \
  template void LevelGather<Dim>::add_elements(const Real*, Real*, int); \
  template void LevelGather<Dim>::fetch_nodes(const Real*, Real*, int)
FABSEQ_INSTANTIATE_GATHER(2, double);
FABSEQ_INSTANTIATE_GATHER(2, float);
FABSEQ_INSTANTIATE_GATHER(3, double);
FABSEQ_INSTANTIATE_GATHER(3, float);

}  // namespace fabseq
