// SPDX-License-Identifier: MIT
/// \file
/// Messages between a rank and a few others. `Value`: double or float.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

namespace fabseq {

/// Nodes or elements whose values go to another rank or come from it, by their numbers here; both ranks have
/// the same order.
struct Peer {
  int rank = 0;
  std::vector<std::int64_t> numbers;
};

/// What goes to another rank, or comes from it. Memory is kept from one exchange to the next.
template <class Value>
struct PeerMessage {
  int rank = 0;
  std::vector<Value> values;
};
template <class Value>
struct PeerBuffers {
  std::vector<PeerMessage<Value>> outgoing, incoming;
};

/// Gives `messages` room for `entries` values of each number, one message for each of `peers`. Local.
template <class Value>
void make_room(std::vector<PeerMessage<Value>>& messages, const std::vector<Peer>& peers,
               std::size_t entries);

/// Sends every one of `outgoing`, and waits for every one of `incoming`, whose sizes are known. A rank has at
/// most one of each for another; one for itself is handed over. `outgoing` is unspecified afterwards. Called
/// by the ranks that have messages for each other, in the same order everywhere.
template <class Value>
void exchange(MPI_Comm comm, std::vector<PeerMessage<Value>>& outgoing,
              std::vector<PeerMessage<Value>>& incoming);

/// The same for buffers of any size: fills them from `values`, [number][entry] with `entries` for each, for
/// `receivers`, and with what `senders` have for this rank.
template <class Value>
void exchange(MPI_Comm comm, const std::vector<Peer>& receivers, const std::vector<Peer>& senders,
              const Value* values, int entries, PeerBuffers<Value>& buffers);

}  // namespace fabseq
