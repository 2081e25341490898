// SPDX-License-Identifier: MIT
#include "ranks/level_gather.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/mpi_struct.h"

#include <algorithm>

namespace fabseq {

template <int Dim>
LevelGather<Dim>::LevelGather(MPI_Comm comm, const LaneMesh<Dim>& stage, const LevelShares<Dim>& coarse)
    : comm_(comm) {
  IndexBox<Dim> all, all_nodes;
  for (int axis = 0; axis < Dim; ++axis) {
    all.size[axis] = coarse.ranges.range_starts[axis].back();
    all_nodes.size[axis] = all.size[axis] + 1;
  }
  const std::vector<int> holders = holders_of_nodes(stage, coarse);
  using Places = std::vector<std::vector<std::int64_t>>;  // in the whole level, of each rank
  Places elements(static_cast<std::size_t>(size_of(comm))), nodes(elements.size());
  stage.element_box().for_each([&](const Index<Dim>& element, std::int64_t) {
    if (stage.element_number(element) >= 0)
      elements[coarse.ranks[coarse.holder_of(element)]].push_back(all.offset(element));
  });
  stage.node_box().for_each([&](const Index<Dim>& node, std::int64_t) {
    const int number = stage.node_number(node);
    if (number >= 0) nodes[coarse.ranks[holders[number]]].push_back(all_nodes.offset(node));
  });
  const Places elements_here = exchange_lists(comm, elements), nodes_here = exchange_lists(comm, nodes);
  if (const int process = coarse.process_of(rank_of(comm)); process >= 0) {
    const IndexBox<Dim> box = coarse.elements_of(process);
    std::vector<char> active(static_cast<std::size_t>(box.count()), 0);
    for (const auto& places : elements_here)
      for (const std::int64_t place : places) active[box.offset(all.index(place))] = 1;
    mesh_ = LaneMesh<Dim>(box, active);
  }
  const auto peers = [](const Places& places, auto&& number) {
    std::vector<Peer> result;
    for (int rank = 0; rank < static_cast<int>(places.size()); ++rank) {
      if (places[rank].empty()) continue;
      Peer& peer = result.emplace_back();
      peer.rank = rank;
      for (const std::int64_t place : places[rank]) peer.numbers.push_back(number(place));
    }
    return result;
  };
  const auto elements_of = [&](const Places& places, const LaneMesh<Dim>& mesh) {
    return peers(places, [&](std::int64_t place) { return mesh.element_number(all.index(place)); });
  };
  const auto nodes_of = [&](const Places& places, const LaneMesh<Dim>& mesh) {
    return peers(places, [&](std::int64_t place) { return mesh.node_number(all_nodes.index(place)); });
  };
  elements_ = {elements_of(elements, stage), elements_of(elements_here, mesh_)};
  nodes_ = {nodes_of(nodes, stage), nodes_of(nodes_here, mesh_)};
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
      int& chosen = holders[stage.node_number(stepped<Dim>(element, corner, 1))];
      if (chosen != home) chosen = holder == home ? home : std::min(chosen, holder);
    }
  });
  return holders;
}

template <int Dim>
template <class Real>
void LevelGather<Dim>::add(const Route& route, const Real* stage, Real* coarse, int entries) {
  auto& buffers = std::get<PeerBuffers<Real>>(buffers_);
  exchange(comm_, route.stage, route.coarse, stage, entries, buffers);
  for (std::size_t i = 0; i < route.coarse.size(); ++i) {
    const Real* value = buffers.incoming[i].values.data();
    for (const std::int64_t number : route.coarse[i].numbers)
      for (int entry = 0; entry < entries; ++entry) coarse[number * entries + entry] += *value++;
  }
}

template <int Dim>
template <class Real>
void LevelGather<Dim>::fetch_nodes(const Real* coarse, Real* stage, int entries) {
  auto& buffers = std::get<PeerBuffers<Real>>(buffers_);
  exchange(comm_, nodes_.coarse, nodes_.stage, coarse, entries, buffers);
  for (std::size_t i = 0; i < nodes_.stage.size(); ++i) {
    const Real* value = buffers.incoming[i].values.data();
    for (const std::int64_t number : nodes_.stage[i].numbers) {
      std::copy_n(value, entries, stage + number * entries);
      value += entries;
    }
  }
}

FABSEQ_INSTANTIATE_CLASS(LevelGather);
#define FABSEQ_INSTANTIATE_GATHER(Dim, Real)                                  \
  template void LevelGather<Dim>::add(const Route&, const Real*, Real*, int); \
  template void LevelGather<Dim>::fetch_nodes(const Real*, Real*, int)
FABSEQ_INSTANTIATE_GATHER(2, double);
FABSEQ_INSTANTIATE_GATHER(2, float);
FABSEQ_INSTANTIATE_GATHER(3, double);
FABSEQ_INSTANTIATE_GATHER(3, float);

}  // namespace fabseq
