// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/lane_mesh.h"
#include "ranks/peer_messages.h"

#include <mpi.h>

#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace fabseq {

/// The nodes of a rank's mesh that other ranks' meshes hold, too, and how to sum over their holders. Every
/// holder gets the very same bits. The values of all lanes travel in one message per neighbour.
class SharedNodes {
 public:
  /// Nobody else.
  SharedNodes() = default;
  /// Collective on `comm`, whose ranks hold meshes of one level of the same grid.
  template <int Dim>
  SharedNodes(MPI_Comm comm, const LaneMesh<Dim>& mesh);

  /// Node numbers, ascending; positions in this list are how kernels refer to them.
  const std::vector<std::int64_t>& nodes() const { return nodes_; }
  /// Whether this rank is the one that counts a node in inner products, by position.
  const std::vector<char>& counted() const { return counted_; }

  /// Sums `values`, [position][entry] with `entries` per node, over the holders of each node. Collective.
  /// `Real`: double or float.
  template <class Real>
  void sum(std::span<Real> values, int entries);

 private:
  template <class Real>
  struct Buffers {
    PeerBuffers<Real> messages;
    std::vector<Real> own;
  };

  MPI_Comm comm_ = MPI_COMM_SELF;
  int rank_ = 0;
  std::vector<std::int64_t> nodes_;
  std::vector<char> counted_;
  std::vector<Peer> neighbors_;  ///< ascending ranks, with positions of the nodes held in common
  std::tuple<Buffers<double>, Buffers<float>> buffers_;
};

}  // namespace fabseq
