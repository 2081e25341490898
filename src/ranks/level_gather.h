// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/lane_mesh.h"
#include "ranks/level_shares.h"
#include "ranks/peer_messages.h"

#include <mpi.h>

#include <cstdint>
#include <tuple>
#include <vector>

namespace fabseq {

/// Takes values from the ranks that hold a level to those that hold the next one, and back, where these are
/// fewer or hold other ranges. What a rank's elements lie in on the next level is its *stage*: coarse
/// elements and nodes whose values it knows in part. Each node of a stage goes to one rank that holds it,
/// most of them to the same; sums over nodes that several of these share are left to SharedNodes. The values
/// of all lanes travel in one message for each rank. Calls that take values are collective on `comm`: ranks
/// that hold nothing of either level have nothing to send.
template <int Dim>
class LevelGather {
 public:
  LevelGather() = default;
  /// `stage`: of this rank, without elements where it holds nothing of the finer level. `coarse`: who holds
  /// the next one. Collective on `comm`, the grid's communicator, which must outlive the object.
  LevelGather(MPI_Comm comm, const LaneMesh<Dim>& stage, const LevelShares<Dim>& coarse);

  /// Process of the next level that each node of a stage goes to. Local.
  static std::vector<int> holders_of_nodes(const LaneMesh<Dim>& stage, const LevelShares<Dim>& coarse);

  /// This rank's part of the next level: what the stages of all ranks have of it.
  const LaneMesh<Dim>& mesh() const { return mesh_; }

  /// coarse += stage; [node][entry] with `entries` for each node. `Real`: double or float.
  template <class Real>
  void add_nodes(const Real* stage, Real* coarse, int entries) {
    add(nodes_, stage, coarse, entries);
  }
  /// coarse += stage; [element][entry].
  template <class Real>
  void add_elements(const Real* stage, Real* coarse, int entries) {
    add(elements_, stage, coarse, entries);
  }
  /// stage = coarse; [node][entry]. All holders of a node have the same bits.
  template <class Real>
  void fetch_nodes(const Real* coarse, Real* stage, int entries);

 private:
  /// What leaves or reaches this rank's stage, and what reaches or leaves its part of the next level.
  struct Route {
    std::vector<Peer> stage, coarse;
  };
  template <class Real>
  void add(const Route& route, const Real* stage, Real* coarse, int entries);

  MPI_Comm comm_ = MPI_COMM_SELF;
  LaneMesh<Dim> mesh_;
  Route elements_, nodes_;
  std::tuple<PeerBuffers<double>, PeerBuffers<float>> buffers_;
};

}  // namespace fabseq
