// SPDX-License-Identifier: MIT
/// \file
/// Messages between a rank and a few others.
#pragma once

#include <mpi.h>

#include <vector>

namespace fabseq {

/// What goes to another rank, or comes from it. Memory is kept from one exchange to the next.
template <class Value>
struct PeerMessage {
  int rank = 0;
  std::vector<Value> values;
};

/// Sends every one of `outgoing`, and waits for every one of `incoming`, whose sizes are known. A rank has at
/// most one of each for another; one for itself is handed over. `outgoing` is unspecified afterwards. Called
/// by the ranks that have messages for each other, in the same order everywhere. `Value`: double, float,
/// std::int64_t.
template <class Value>
void exchange(MPI_Comm comm, std::vector<PeerMessage<Value>>& outgoing,
              std::vector<PeerMessage<Value>>& incoming);

/// The same where only the sender knows the sizes: two messages for each.
template <class Value>
void exchange_unsized(MPI_Comm comm, std::vector<PeerMessage<Value>>& outgoing,
                      std::vector<PeerMessage<Value>>& incoming);

}  // namespace fabseq
