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
/// the layers. Hence rank p of every group has the same elements and nodes; its *copies* are the ranks p of
/// the other groups. The rank in the world is group * (ranks per group) + p.
///
/// Fields are the same on all copies, bit for bit. Vectors with one entry per design variable are split among
/// the copies instead: each has a *share*, a contiguous range of the entries. All calls but the plain queries
/// and share() are collective on across().
class LayerGroups {
 public:
  /// Collective on `world`, which must outlive the object. `count`, the number of groups, must divide the
  /// number of its ranks.
  LayerGroups(MPI_Comm world, int count);

  MPI_Comm world() const { return world_; }
  /// The ranks of this rank's group; the grid is decomposed over them.
  MPI_Comm domain() const { return count_ == 1 ? world_ : domain_; }
  /// This rank and its copies, in the order of the groups.
  MPI_Comm across() const { return count_ == 1 ? MPI_COMM_SELF : across_; }
  int count() const { return count_; }
  /// Index of this rank's group, from 0.
  int index() const { return index_; }

  /// This rank's share of a field that it and its copies have. Local.
  std::vector<double> share(std::span<const double> field) const;
  /// Number of the first entry of this rank's share of a field with so many entries. Local.
  std::size_t first_of_share(std::size_t length) const { return first_of_share(length, index_); }
  /// The same of the copy in `group`; in group count(), the number of entries. Local.
  std::size_t first_of_share(std::size_t length, int group) const { return length * group / count_; }
  /// The whole field, from the shares of this rank and its copies.
  std::vector<double> gather(std::span<const double> share) const;
  /// This rank's shares of several fields, each of which exists in one group only. `owners`: the group of
  /// each field. `own`: the fields of this rank's group, in the order in which they stand in `owners`.
  /// `length`: number of entries of every field. Any two copies exchange one message.
  std::vector<std::vector<double>> share_out(std::span<const std::vector<double>> own,
                                             std::span<const int> owners, std::size_t length) const;

  /// Sum over the copies, entry by entry, in place.
  void sum(std::span<double> values) const;
  void sum(std::span<int> values) const;
  /// The same, but only group `owner` gets the sum. In other groups `values` are unspecified afterwards.
  void sum_at(int owner, std::span<double> values) const;
  /// Copies the values of group `owner` to all copies, in place.
  void broadcast(int owner, std::span<double> values) const;
  /// A field of so many entries that the first group finds for all, as a single right-hand side cannot be
  /// shared out. Collective on world(); errors are thrown in all groups.
  std::vector<double> from_first(std::size_t length, const std::function<std::vector<double>()>& work) const;
  /// Runs work in which each group acts on its own. If it fails in one group, the error is thrown in all
  /// (run_in_groups()).
  void run(const std::function<void()>& work) const;

 private:
  MPI_Comm world_;
  int count_ = 1, index_ = 0;
  Communicator domain_, across_;  ///< null with one group
};

}  // namespace fabseq
