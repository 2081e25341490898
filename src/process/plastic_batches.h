// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/parallel/layer_groups.h"
#include "process/plastic_point.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace fabseq {

/// This rank's share of the model's elements, whose histories it finds, in batches of eight elements. They
/// are gone through in chunks that fit into a cache. Local.
class PlasticBatches {
 public:
  /// Numbers of consecutive elements, at most eight.
  class Batch {
   public:
    Batch(int first, std::size_t size) : first_(first), size_(size) {}
    std::size_t size() const { return size_; }
    int operator[](std::size_t index) const { return first_ + static_cast<int>(index); }

   private:
    int first_;
    std::size_t size_;
  };
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
  Batch batch(std::size_t number) const {
    const std::size_t first = begin_ + number * plastic_width;
    return {static_cast<int>(first), std::min<std::size_t>(plastic_width, end_ - first)};
  }

 private:
  std::size_t all_elements_, begin_, end_;  ///< the share: begin .. end - 1
  std::vector<Chunk> chunks_;
};

}  // namespace fabseq
