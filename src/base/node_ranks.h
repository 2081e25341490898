// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/mpi.h"

namespace fabseq {

/// The ranks of a communicator that run on this rank's node, a machine with a memory of its own. Constructor
/// and destructor are collective on the communicator.
class NodeRanks {
 public:
  explicit NodeRanks(MPI_Comm comm) {
    MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node_);
  }
  NodeRanks(NodeRanks&&) = delete;
  ~NodeRanks() { MPI_Comm_free(&node_); }

  MPI_Comm comm() const { return node_; }
  int count() const { return size_of(node_); }
  /// True on one rank of each node.
  bool is_first() const { return rank_of(node_) == 0; }

 private:
  MPI_Comm node_ = MPI_COMM_NULL;
};

}  // namespace fabseq
