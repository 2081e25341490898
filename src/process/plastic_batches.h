// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "process/plastic_point.h"

#include <algorithm>
#include <cstddef>
#include <ranges>
#include <vector>

namespace fabseq {

/// This rank's share of the model's elements, whose histories it finds, in batches of eight elements. They
/// are gone through in chunks that fit into a cache. Local.
class PlasticBatches {
 public:
  /// Elements of the share, first .. first + count - 1, whose batches begin with `batch`.
  struct Chunk {
    std::size_t first, count, batch;
    std::size_t batches() const;
  };

  /// `elements`: those of the model, the same on all copies of the rank.
  PlasticBatches(const LayerGroups& groups, std::size_t elements);

  const std::vector<Chunk>& chunks() const { return chunks_; }
  std::size_t count() const;
  std::size_t elements() const { return all_elements_; }
  /// The elements of a batch: as many as it has.
  auto batch(std::size_t number) const {
    const std::size_t first = begin_ + number * plastic_width;
    return std::views::iota(static_cast<int>(first), static_cast<int>(std::min(first + plastic_width, end_)));
  }

 private:
  std::size_t all_elements_, begin_, end_;  ///< the share: begin .. end - 1
  std::vector<Chunk> chunks_;
};

}  // namespace fabseq
