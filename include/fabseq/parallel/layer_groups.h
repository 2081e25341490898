// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/mpi.h"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace fabseq {

/// The ranks of a run as groups of equal size that share the layers (docs/architecture.md, distribution).
/// Every group holds the whole box, decomposed over its ranks in the same way, and solves for its share of
/// the layers. So rank p of every group has the same elements and nodes: its *copies* are the ranks p of the
/// other groups. Rank = group * (ranks of a group) + p.
///
/// Fields are the same on all copies, bit for bit, but what has one entry per design variable is split among
/// them: each has a *share*, a contiguous range of the entries. All calls but the plain queries are
/// collective on across().
class LayerGroups {
 public:
  /// Collective on `world`, which must outlive the object; `count` divides its ranks.
  LayerGroups(MPI_Comm world, int count);

  MPI_Comm world() const { return world_; }
  /// This rank's group: what the grid is decomposed over.
  MPI_Comm domain() const { return count_ == 1 ? world_ : domain_; }
  /// This rank and its copies, in the order of the groups.
  MPI_Comm across() const { return count_ == 1 ? MPI_COMM_SELF : across_; }
  int count() const { return count_; }
  /// Number of this rank's group, from 0.
  int index() const { return index_; }

  /// This rank's share of a field that it and its copies have.
  std::vector<double> share(std::span<const double> field) const;
  /// The field whose shares this rank and its copies have.
  std::vector<double> gather(std::span<const double> share) const;
  /// Shares of fields that each exist in one group only. `owners`: the group that has each field; `own`: this
  /// group's, in their order; `length`: entries of every field. One message between any two copies.
  std::vector<std::vector<double>> share_out(std::span<const std::vector<double>> own,
                                             std::span<const int> owners, std::size_t length) const;

  /// Sum of the copies' values, in place.
  void sum(std::span<double> values) const;
  void sum(std::span<int> values) const;
  /// The same, but only group `owner` gets the sum; elsewhere `values` are used up.
  void sum_at(int owner, std::span<double> values) const;
  /// Values of group `owner` on all copies.
  void broadcast(int owner, std::span<double> values) const;
  /// Runs work in which each group acts on its own; if it fails in one, the error is thrown in all.
  void run(const std::function<void()>& work) const;

 private:
  /// First entry of a group's share of `length` entries.
  std::size_t start(std::size_t length, int group) const { return length * group / count_; }

  MPI_Comm world_;
  int count_ = 1, index_ = 0;
  Communicator domain_, across_;  ///< null with one group
};

}  // namespace fabseq
