// SPDX-License-Identifier: MIT
/// \file
/// Memory of the lane solver.
#pragma once

#include "fabseq/base/large_pages.h"

#include <array>
#include <cstddef>
#include <new>
#include <span>
#include <vector>

namespace fabseq {

/// Allocates on cache lines, so that a vector register never straddles two. What is large gets pages of 2
/// MiB, where the system has them: kernels that walk through many arrays at once would wait for the addresses
/// of small pages.
template <class Value>
struct CacheLineAllocator {
  using value_type = Value;

  CacheLineAllocator() = default;
  template <class Other>
  CacheLineAllocator(const CacheLineAllocator<Other>&) {}

  Value* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(Value);
    return static_cast<Value*>(bytes < large ? ::operator new(bytes, cache_line) : map_large_pages(bytes));
  }
  void deallocate(Value* place, std::size_t count) {
    const std::size_t bytes = count * sizeof(Value);
    if (bytes < large)
      ::operator delete(place, cache_line);
    else
      unmap_large_pages(place);
  }
  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }

 private:
  static constexpr std::align_val_t cache_line{64};
  static constexpr std::size_t large = 2 * large_page;
};

/// [node][component][lane] on a level's own nodes, or [element][lane].
template <class Real>
using LaneValues = std::vector<Real, CacheLineAllocator<Real>>;
using LaneArray = LaneValues<double>;

/// Empties a vector and gives its memory back.
template <class Vector>
void free_memory(Vector& values) {
  Vector().swap(values);
}

/// One number per lane.
template <int Width>
using LaneScalars = std::array<double, Width>;

/// The lane to take for `lane` where `lanes` are selected: beyond them, the first of them again.
inline int selected(std::span<const int> lanes, int lane) {
  return lane < static_cast<int>(lanes.size()) ? lanes[lane] : lanes[0];
}

/// Copies lanes of `from` (`from_width` wide) to the leading ones of `to`; where there are fewer, the first
/// of them again.
template <class Array>
void select_lanes(const Array& from, int from_width, std::span<const int> lanes, Array& to, int to_width) {
  const std::size_t count = from.size() / from_width;
  to.resize(count * to_width);
  for (std::size_t i = 0; i < count; ++i)
    for (int lane = 0; lane < to_width; ++lane)
      to[i * to_width + lane] = from[i * from_width + selected(lanes, lane)];
}

}  // namespace fabseq
