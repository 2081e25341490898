// SPDX-License-Identifier: MIT
#include "process/plastic_batches.h"

namespace fabseq {

namespace {

/// Elements whose histories of eight steps stay in a cache.
constexpr std::size_t chunk_elements = 64;

std::size_t batches_of(std::size_t elements) { return (elements + plastic_width - 1) / plastic_width; }

}  // namespace

std::size_t PlasticBatches::Chunk::batches() const { return batches_of(count); }

PlasticBatches::PlasticBatches(const LayerGroups& groups, std::size_t elements)
    : all_elements_(elements),
      begin_(groups.first_of_share(elements)),
      end_(groups.first_of_share(elements, groups.index() + 1)) {
  // With more groups a wave has more steps. Chunks have whole batches.
  const std::size_t batches = std::max<std::size_t>(1, batches_of(chunk_elements) / groups.count());
  for (std::size_t batch = 0; batch < count(); batch += batches) {
    const std::size_t first = begin_ + batch * plastic_width;
    chunks_.push_back({first, std::min(batches * plastic_width, end_ - first), batch});
  }
}

std::size_t PlasticBatches::count() const { return batches_of(end_ - begin_); }

}  // namespace fabseq
