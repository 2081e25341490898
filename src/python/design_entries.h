// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fabseq {

/// The entries of designs and gradients on the ranks of a run. Each rank has its share of them, and the
/// *whole vector* lists all of them in an order that does not depend on the ranks. All calls but the plain
/// queries are collective on the world.
class DesignEntries {
 public:
  /// `numbers`: one for each entry of this rank's share; the whole vector is sorted by them. `world` must
  /// outlive the object.
  DesignEntries(MPI_Comm world, const std::vector<std::int64_t>& numbers)
      : world_(world),
        share_(numbers.size()),
        first_(exclusive_sum(world, static_cast<std::int64_t>(numbers.size()))) {
    const std::vector<std::int64_t> all = gather_all(world, numbers);
    std::vector<std::int64_t> sorted = all;
    std::sort(sorted.begin(), sorted.end());
    for (const std::int64_t number : all)
      places_.push_back(std::lower_bound(sorted.begin(), sorted.end(), number) - sorted.begin());
  }

  /// Number of entries of this rank's share.
  std::size_t share() const { return share_; }

  /// The whole vector, on every rank.
  std::vector<double> gather(std::span<const double> share) const {
    require("share", share, share_);
    const std::vector<double> all = gather_all(world_, share);
    std::vector<double> whole(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) whole[places_[i]] = all[i];
    return whole;
  }
  /// This rank's share of the whole vector.
  std::vector<double> share_of(std::span<const double> whole) const {
    require("whole", whole, places_.size());
    std::vector<double> result;
    for (std::size_t i = 0; i < share_; ++i) result.push_back(whole[places_[first_ + i]]);
    return result;
  }

  /// Throws InputError on all ranks unless each one has so many finite values. `what`: their name in
  /// messages.
  void require(const char* what, std::span<const double> values, std::size_t count) const {
    run_on_all(world_, [&] {
      if (values.size() != count)
        throw InputError(std::string(what) + ": found " + std::to_string(values.size()) +
                         " values; allowed: " + std::to_string(count));
      if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }))
        throw InputError(std::string(what) + ": found a value that is not finite; allowed: finite values");
    });
  }

 private:
  MPI_Comm world_;
  std::size_t share_;
  std::int64_t first_;                  ///< place of this rank's first entry among all, rank after rank
  std::vector<std::ptrdiff_t> places_;  ///< in the whole vector, of all entries, rank after rank
};

}  // namespace fabseq
