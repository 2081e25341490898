// SPDX-License-Identifier: MIT
#include "ranks/lane_deal.h"

#include "fabseq/base/mpi.h"

#include <algorithm>

namespace fabseq {

LaneDeal::LaneDeal(MPI_Comm comm, std::span<const std::int64_t> numbers)
    : comm_(comm), rank_(rank_of(comm)), own_nodes_(static_cast<std::int64_t>(numbers.size())) {
  const std::vector<std::int64_t> counts = gather_all(comm, std::span(&own_nodes_, 1));
  const std::vector<std::int64_t> all = gather_all(comm, numbers);
  auto next = all.begin();
  for (int rank = 0; rank < static_cast<int>(counts.size()); ++rank) {
    if (counts[rank] == 0) continue;
    holders_.push_back({rank, {next, next + counts[rank]}});
    next += counts[rank];
  }
}

template <class Real>
LaneDeal::Buffers<Real>& LaneDeal::sized(std::span<const int> owners, int components) {
  auto& buffers = std::get<Buffers<Real>>(buffers_);
  std::vector<int> ranks(owners.begin(), owners.end());
  std::sort(ranks.begin(), ranks.end());
  ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
  const auto lanes = [&](int rank) { return std::count(owners.begin(), owners.end(), rank); };
  buffers.of_owner.resize(own_nodes_ > 0 ? ranks.size() : 0);
  for (std::size_t i = 0; i < buffers.of_owner.size(); ++i) {
    buffers.of_owner[i].rank = ranks[i];
    buffers.of_owner[i].values.resize(own_nodes_ * components * lanes(ranks[i]));
  }
  if (lanes(rank_) > 0)
    make_room(buffers.of_holder, holders_, components * lanes(rank_));
  else
    buffers.of_holder.clear();
  return buffers;
}

template <class Real>
void LaneDeal::add_at_owners(std::span<const int> owners, const Layout& layout, const Real* parts,
                             double* sums) {
  auto& [of_holder, of_owner] = sized<Real>(owners, layout.components);
  const auto width = static_cast<std::int64_t>(owners.size());
  for (auto& message : of_owner) {
    Real* place = message.values.data();
    for (std::int64_t i = 0; i < own_nodes_ * layout.components; ++i)
      for (std::int64_t lane = 0; lane < width; ++lane)
        if (owners[lane] == message.rank) *place++ = parts[i * width + lane];
  }
  exchange(comm_, of_owner, of_holder);
  for (std::size_t i = 0; i < of_holder.size(); ++i) {
    const Real* value = of_holder[i].values.data();
    for (const std::int64_t node : holders_[i].numbers)
      for (int a = 0; a < layout.components; ++a)
        for (std::int64_t lane = 0; lane < width; ++lane)
          if (owners[lane] == rank_)
            sums[layout.rows[node * layout.components + a] * layout.row_stride + lane * layout.lane_stride] +=
                static_cast<double>(*value++);
  }
}

template <class Real>
void LaneDeal::fetch_from_owners(std::span<const int> owners, const Layout& layout, const double* found,
                                 Real* parts) {
  auto& [of_holder, of_owner] = sized<Real>(owners, layout.components);
  const auto width = static_cast<std::int64_t>(owners.size());
  for (std::size_t i = 0; i < of_holder.size(); ++i) {
    Real* place = of_holder[i].values.data();
    for (const std::int64_t node : holders_[i].numbers)
      for (int a = 0; a < layout.components; ++a)
        for (std::int64_t lane = 0; lane < width; ++lane)
          if (owners[lane] == rank_)
            *place++ = static_cast<Real>(found[layout.rows[node * layout.components + a] * layout.row_stride +
                                               lane * layout.lane_stride]);
  }
  exchange(comm_, of_holder, of_owner);
  for (const auto& message : of_owner) {
    const Real* value = message.values.data();
    for (std::int64_t i = 0; i < own_nodes_ * layout.components; ++i)
      for (std::int64_t lane = 0; lane < width; ++lane)
        if (owners[lane] == message.rank) parts[i * width + lane] = *value++;
  }
}

template void LaneDeal::add_at_owners(std::span<const int>, const Layout&, const double*, double*);
template void LaneDeal::add_at_owners(std::span<const int>, const Layout&, const float*, double*);
template void LaneDeal::fetch_from_owners(std::span<const int>, const Layout&, const double*, double*);
template void LaneDeal::fetch_from_owners(std::span<const int>, const Layout&, const double*, float*);

}  // namespace fabseq
