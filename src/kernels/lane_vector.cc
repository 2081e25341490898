// SPDX-License-Identifier: MIT
#include "fabseq/kernels/lane_vector.h"

#include <algorithm>

namespace fabseq {

void resize(LaneVector& vector, int nodes, int components, int lanes) {
  const std::size_t size = static_cast<std::size_t>(nodes) * components * lanes;
  vector.nodes = nodes;
  vector.components = components;
  vector.lanes = lanes;
  if (vector.values.capacity() < size) vector.values = {};  // nothing is to be moved
  vector.values.resize(size);
}

void pick(const LaneVector& all, std::span<const int> nodes, LaneVector& some, double factor) {
  resize(some, static_cast<int>(nodes.size()), all.components, all.lanes);
  const std::ptrdiff_t block = static_cast<std::ptrdiff_t>(all.components) * all.lanes;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    std::transform(all.values.begin() + nodes[k] * block, all.values.begin() + (nodes[k] + 1) * block,
                   some.values.begin() + k * block, [factor](double value) { return factor * value; });
}

void spread(const LaneVector& some, std::span<const int> nodes, int count, LaneVector& all) {
  resize(all, count, some.components, some.lanes);
  const std::ptrdiff_t block = static_cast<std::ptrdiff_t>(some.components) * some.lanes;
  auto to = all.values.begin();
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto place = all.values.begin() + nodes[k] * block;
    std::fill(to, place, 0.0);
    to = std::copy_n(some.values.begin() + k * block, block, place);
  }
  std::fill(to, all.values.end(), 0.0);
}

}  // namespace fabseq
