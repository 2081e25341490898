// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

namespace fabseq {

/// Sets of numbers from 0 on that can be joined; each has a representative.
class DisjointSets {
 public:
  DisjointSets() = default;
  /// So many sets of one number each.
  explicit DisjointSets(std::size_t count) { append(count); }

  int size() const { return static_cast<int>(parent_.size()); }
  void append(std::size_t count = 1) {
    for (std::size_t i = 0; i < count; ++i) parent_.push_back(static_cast<int>(parent_.size()));
  }
  int find(int member) {
    while (parent_[member] != member) member = parent_[member] = parent_[parent_[member]];
    return member;
  }
  /// Joins the sets of two members; the representative is `into`'s. Returns whether they were two.
  bool join(int member, int into) {
    const int from = find(member), to = find(into);
    parent_[from] = to;
    return from != to;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace fabseq
