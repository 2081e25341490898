// SPDX-License-Identifier: MIT
#include "process/plastic_batches.h"

#include "process/plastic_point.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Elements of a chunk for each copy: with one copy the histories of eight steps stay in a cache, with more
/// of them messages are long enough.
constexpr std::size_t chunk_of_one = 64, chunk_of_many = 1024;

}  // namespace

std::size_t PlasticBatches::Chunk::batches() const { return (count + plastic_width - 1) / plastic_width; }

PlasticBatches::PlasticBatches(const LayerGroups& groups, std::size_t elements) : all_elements_(elements) {
  const std::size_t size = groups.count() == 1 ? chunk_of_one : chunk_of_many * groups.count();
  for (std::size_t begin = 0; begin < elements; begin += size) {
    const std::size_t end = std::min(elements, begin + size);
    Chunk chunk{begin, end, begin + groups.first_of_share(end - begin), 0, elements_.size()};
    chunk.count = begin + groups.first_of_share(end - begin, groups.index() + 1) - chunk.first;
    for (std::size_t e = 0; e < chunk.count; ++e) {
      if (e % plastic_width == 0) elements_.emplace_back();
      elements_.back().push_back(static_cast<int>(chunk.first + e));
    }
    chunks_.push_back(chunk);
  }
}

}  // namespace fabseq
