// SPDX-License-Identifier: MIT
#include "fabseq/parallel/layer_groups.h"

#include "fabseq/base/petsc.h"  // so that -log_view counts the messages sent here
#include "fabseq/base/verdict.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace fabseq {

LayerGroups::LayerGroups(MPI_Comm world, int count) : world_(world), count_(count) {
  if (count_ == 1) return;
  const int rank = rank_of(world_), ranks_a_group = size_of(world_) / count_;
  index_ = rank / ranks_a_group;
  domain_ = Communicator(world_, index_, rank);
  across_ = Communicator(world_, rank % ranks_a_group, rank);
}

std::vector<double> LayerGroups::share(std::span<const double> field) const {
  const auto begin = field.begin();
  return {begin + static_cast<std::ptrdiff_t>(first_of_share(field.size(), index_)),
          begin + static_cast<std::ptrdiff_t>(first_of_share(field.size(), index_ + 1))};
}

std::vector<double> LayerGroups::gather(std::span<const double> share) const {
  return gather_all(across(), share);
}

std::vector<std::vector<double>> LayerGroups::share_out(std::span<const std::vector<double>> own,
                                                        std::span<const int> owners,
                                                        std::size_t length) const {
  if (count_ == 1) return {own.begin(), own.end()};
  if (owners.size() > 1 && owners.size() * length > std::size_t{1} << 30) {  // MPI counts to 2^31
    const auto early = owners.first(owners.size() / 2), late = owners.last(owners.size() - early.size());
    const auto of_early = static_cast<std::size_t>(std::count(early.begin(), early.end(), index_));
    auto shares = share_out(own.first(of_early), early, length);
    for (auto& share : share_out(own.subspan(of_early), late, length)) shares.push_back(std::move(share));
    return shares;
  }
  const auto share_of = [&](int group) {
    return first_of_share(length, group + 1) - first_of_share(length, group);
  };
  std::vector<int> sent(count_), sent_starts(count_), received(count_), received_starts(count_);
  for (int group = 0; group < count_; ++group) {
    sent[group] = static_cast<int>(own.size() * share_of(group));
    for (const int owner : owners)
      if (owner == group) received[group] += static_cast<int>(share_of(index_));
  }
  std::exclusive_scan(sent.begin(), sent.end(), sent_starts.begin(), 0);
  std::exclusive_scan(received.begin(), received.end(), received_starts.begin(), 0);
  std::vector<double> outgoing, incoming(static_cast<std::size_t>(received_starts.back()) + received.back());
  for (int group = 0; group < count_; ++group)
    for (const std::vector<double>& field : own) {
      const auto begin = field.begin() + static_cast<std::ptrdiff_t>(first_of_share(length, group));
      outgoing.insert(outgoing.end(), begin, begin + static_cast<std::ptrdiff_t>(share_of(group)));
    }
  MPI_Alltoallv(outgoing.data(), sent.data(), sent_starts.data(), MPI_DOUBLE, incoming.data(),
                received.data(), received_starts.data(), MPI_DOUBLE, across());

  // The fields of a group arrive in the order in which it has them.
  std::vector<std::vector<double>> shares;
  for (const int owner : owners) {
    const auto begin = incoming.begin() + received_starts[owner];
    const auto entries = static_cast<std::ptrdiff_t>(share_of(index_));
    shares.emplace_back(begin, begin + entries);
    received_starts[owner] += static_cast<int>(entries);
  }
  return shares;
}

void LayerGroups::sum(std::span<double> values) const {
  if (count_ > 1) sum_in_place(across_, values);
}

void LayerGroups::sum(std::span<int> values) const {
  if (count_ > 1) sum_in_place(across_, values);
}

void LayerGroups::sum_at(int owner, std::span<double> values) const {
  if (count_ == 1) return;
  const bool is_owner = index_ == owner;
  for_each_message(values, [&](std::span<double> part) {
    MPI_Reduce(is_owner ? MPI_IN_PLACE : part.data(), is_owner ? part.data() : nullptr,
               static_cast<int>(part.size()), MPI_DOUBLE, MPI_SUM, owner, across_);
  });
}

void LayerGroups::broadcast(int owner, std::span<double> values) const {
  if (count_ > 1) fabseq::broadcast(across_, values, owner);
}

std::vector<double> LayerGroups::from_first(std::size_t length,
                                            const std::function<std::vector<double>()>& work) const {
  std::vector<double> result(length);
  run([&] {
    if (index() == 0) result = work();
  });
  broadcast(0, result);
  return result;
}

void LayerGroups::run(const std::function<void()>& work) const { run_in_groups(across(), work); }

}  // namespace fabseq
