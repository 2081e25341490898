// SPDX-License-Identifier: MIT
#include "process/plastic_batches.h"

#include "process/plastic_point.h"

#include <algorithm>

namespace fabseq {

namespace {

/// The histories of eight steps of so many elements stay in a cache.
constexpr std::size_t chunk_elements = 64;

}  // namespace

std::size_t PlasticBatches::Chunk::batches() const { return (count + plastic_width - 1) / plastic_width; }

PlasticBatches::PlasticBatches(const LayerGroups& groups, std::size_t elements) : all_elements_(elements) {
  const std::size_t end = groups.first_of_share(elements, groups.index() + 1);
  for (std::size_t first = groups.first_of_share(elements); first < end; first += chunk_elements) {
    const Chunk chunk{first, std::min(chunk_elements, end - first), elements_.size()};
    for (std::size_t e = 0; e < chunk.count; ++e) {
      if (e % plastic_width == 0) elements_.emplace_back();
      elements_.back().push_back(static_cast<int>(first + e));
    }
    chunks_.push_back(chunk);
  }
}

}  // namespace fabseq
