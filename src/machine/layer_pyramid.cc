// SPDX-License-Identifier: MIT
#include "fabseq/machine/layer_pyramid.h"

#include <algorithm>
#include <limits>

namespace fabseq {

template <int Dim>
LayerPyramid<Dim>::LayerPyramid(const IndexBox<Dim>& box, std::span<const double> layers)
    : start_(box.start) {
  levels_.push_back({{{}, box.size}, std::vector<float>(layers.begin(), layers.end())});
  while (levels_.back().box.count() > 1) {
    const Level& finer = levels_.back();
    Level level;
    for (int axis = 0; axis < Dim; ++axis) level.box.size[axis] = (finer.box.size[axis] + 1) / 2;
    level.earliest.assign(static_cast<std::size_t>(level.box.count()),
                          std::numeric_limits<float>::infinity());
    finer.box.for_each([&](Index<Dim> index, std::int64_t offset) {
      for (int& entry : index) entry /= 2;
      float& earliest = level.earliest[level.box.offset(index)];
      earliest = std::min(earliest, finer.earliest[offset]);
    });
    levels_.push_back(std::move(level));
  }
}

template <int Dim>
int LayerPyramid<Dim>::last(const Block& block, int axis) const {
  const int end = std::min((block.index[axis] + 1) << block.level, levels_.front().box.size[axis]);
  return start_[axis] + end - 1;
}

FABSEQ_INSTANTIATE_CLASS(LayerPyramid);

}  // namespace fabseq
