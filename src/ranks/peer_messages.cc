// SPDX-License-Identifier: MIT
#include "ranks/peer_messages.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/petsc.h"  // -log_view counts what is sent here

#include <algorithm>
#include <type_traits>
#include <utility>

namespace fabseq {

template <class Value>
void make_room(std::vector<PeerMessage<Value>>& messages, const std::vector<Peer>& peers,
               std::size_t entries) {
  messages.resize(peers.size());
  for (std::size_t i = 0; i < peers.size(); ++i) {
    messages[i].rank = peers[i].rank;
    messages[i].values.resize(peers[i].numbers.size() * entries);
  }
}

template <class Value>
void exchange(MPI_Comm comm, std::vector<PeerMessage<Value>>& outgoing,
              std::vector<PeerMessage<Value>>& incoming) {
  const MPI_Datatype type = std::is_same_v<Value, double> ? MPI_DOUBLE : MPI_FLOAT;
  const int own = rank_of(comm);
  std::vector<MPI_Request> requests;
  for (PeerMessage<Value>& message : incoming)
    if (message.rank != own)
      MPI_Irecv(message.values.data(), static_cast<int>(message.values.size()), type, message.rank, 0, comm,
                &requests.emplace_back());
  for (PeerMessage<Value>& message : outgoing) {
    if (message.rank != own) {
      MPI_Isend(message.values.data(), static_cast<int>(message.values.size()), type, message.rank, 0, comm,
                &requests.emplace_back());
      continue;
    }
    for (PeerMessage<Value>& to : incoming)
      if (to.rank == own) std::swap(to.values, message.values);
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

template <class Value>
void exchange(MPI_Comm comm, const std::vector<Peer>& receivers, const std::vector<Peer>& senders,
              const Value* values, int entries, PeerBuffers<Value>& buffers) {
  make_room(buffers.outgoing, receivers, entries);
  make_room(buffers.incoming, senders, entries);
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    Value* place = buffers.outgoing[i].values.data();
    for (const std::int64_t number : receivers[i].numbers)
      place = std::copy_n(values + number * entries, entries, place);
  }
  exchange(comm, buffers.outgoing, buffers.incoming);
}

#define FABSEQ_INSTANTIATE_MESSAGES(Value)                                                                \
  template void make_room(std::vector<PeerMessage<Value>>&, const std::vector<Peer>&, std::size_t);       \
  template void exchange(MPI_Comm, std::vector<PeerMessage<Value>>&, std::vector<PeerMessage<Value>>&);   \
  template void exchange(MPI_Comm, const std::vector<Peer>&, const std::vector<Peer>&, const Value*, int, \
                         PeerBuffers<Value>&)
FABSEQ_INSTANTIATE_MESSAGES(double);
FABSEQ_INSTANTIATE_MESSAGES(float);

}  // namespace fabseq
