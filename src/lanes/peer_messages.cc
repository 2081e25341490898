// SPDX-License-Identifier: MIT
#include "fabseq/lanes/peer_messages.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/petsc.h"  // -log_view counts what is sent here

#include <cstdint>
#include <type_traits>
#include <utility>

namespace fabseq {

namespace {

/// Apart from the messages of SharedNodes on the same communicator.
constexpr int tag = 1;

template <class Value>
MPI_Datatype type_of() {
  if constexpr (std::is_same_v<Value, double>)
    return MPI_DOUBLE;
  else if constexpr (std::is_same_v<Value, float>)
    return MPI_FLOAT;
  else
    return MPI_INT64_T;
}

}  // namespace

template <class Value>
void exchange(MPI_Comm comm, std::vector<PeerMessage<Value>>& outgoing,
              std::vector<PeerMessage<Value>>& incoming) {
  const int own = rank_of(comm);
  std::vector<MPI_Request> requests;
  for (PeerMessage<Value>& message : incoming)
    if (message.rank != own)
      MPI_Irecv(message.values.data(), static_cast<int>(message.values.size()), type_of<Value>(),
                message.rank, tag, comm, &requests.emplace_back());
  for (PeerMessage<Value>& message : outgoing) {
    if (message.rank != own) {
      MPI_Isend(message.values.data(), static_cast<int>(message.values.size()), type_of<Value>(),
                message.rank, tag, comm, &requests.emplace_back());
      continue;
    }
    for (PeerMessage<Value>& to : incoming)
      if (to.rank == own) std::swap(to.values, message.values);
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

template <class Value>
void exchange_unsized(MPI_Comm comm, std::vector<PeerMessage<Value>>& outgoing,
                      std::vector<PeerMessage<Value>>& incoming) {
  std::vector<PeerMessage<std::int64_t>> outgoing_sizes, incoming_sizes;
  for (const PeerMessage<Value>& message : outgoing)
    outgoing_sizes.push_back({message.rank, {static_cast<std::int64_t>(message.values.size())}});
  for (const PeerMessage<Value>& message : incoming) incoming_sizes.push_back({message.rank, {0}});
  exchange(comm, outgoing_sizes, incoming_sizes);
  for (std::size_t i = 0; i < incoming.size(); ++i)
    incoming[i].values.resize(static_cast<std::size_t>(incoming_sizes[i].values[0]));
  exchange(comm, outgoing, incoming);
}

#define FABSEQ_INSTANTIATE_MESSAGES(Value) \
  template void exchange(MPI_Comm, std::vector<PeerMessage<Value>>&, std::vector<PeerMessage<Value>>&)
FABSEQ_INSTANTIATE_MESSAGES(double);
FABSEQ_INSTANTIATE_MESSAGES(float);
FABSEQ_INSTANTIATE_MESSAGES(std::int64_t);
template void exchange_unsized(MPI_Comm, std::vector<PeerMessage<std::int64_t>>&,
                               std::vector<PeerMessage<std::int64_t>>&);

}  // namespace fabseq
