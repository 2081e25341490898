// SPDX-License-Identifier: MIT
#pragma once

#include "ranks/peer_messages.h"

#include <mpi.h>

#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace fabseq {

/// Takes the right-hand sides of the last level, lane by lane, to the ranks that solve them, and the
/// solutions back to those that need them: the ranks that hold the level above. One message between any two
/// of them for all lanes that the one solves. The last level's mesh is whole on every rank.
class LaneDeal {
 public:
  /// Where a value is in the arrays of whoever solves: rows[node * components + component] * row_stride +
  /// lane * lane_stride.
  struct Layout {
    std::span<const int> rows;
    int components = 0;
    std::size_t row_stride = 0, lane_stride = 0;
  };

  LaneDeal() = default;
  /// `numbers`: of this rank's nodes of the last level that its elements of the level above lie in, in the
  /// last level's mesh. Collective on `comm`, the grid's communicator, which must outlive the object.
  LaneDeal(MPI_Comm comm, std::span<const std::int64_t> numbers);

  /// Adds the parts of all ranks, [node][component][lane], to `sums` at the ranks that solve. `owners`: rank
  /// that solves each lane. Collective. `Real`: double or float.
  template <class Real>
  void add_at_owners(std::span<const int> owners, const Layout& layout, const Real* parts, double* sums);
  /// Hands out what the owners of lanes have found. Collective.
  template <class Real>
  void fetch_from_owners(std::span<const int> owners, const Layout& layout, const double* found, Real* parts);

 private:
  template <class Real>
  struct Buffers {
    std::vector<PeerMessage<Real>> of_holder, of_owner;
  };
  /// Messages of this rank: as an owner, one for each holder; as a holder, one for each owner.
  template <class Real>
  Buffers<Real>& sized(std::span<const int> owners, int components);

  MPI_Comm comm_ = MPI_COMM_SELF;
  int rank_ = 0;
  std::vector<Peer> holders_;  ///< of some of the level above, with their nodes
  std::int64_t own_nodes_ = 0;
  std::tuple<Buffers<double>, Buffers<float>> buffers_;
};

}  // namespace fabseq
