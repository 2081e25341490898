// SPDX-License-Identifier: MIT
/// \file
/// Data of the lane solver: memory, vectors, when a solve stops and how it ended.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <vector>

namespace fabseq {

/// Allocates on cache lines, so that a vector register never straddles two.
template <class Value>
struct CacheLineAllocator {
  using value_type = Value;
  static constexpr std::align_val_t alignment{64};

  CacheLineAllocator() = default;
  template <class Other>
  CacheLineAllocator(const CacheLineAllocator<Other>&) {}

  Value* allocate(std::size_t count) {
    return static_cast<Value*>(::operator new(count * sizeof(Value), alignment));
  }
  void deallocate(Value* place, std::size_t) { ::operator delete(place, alignment); }
  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
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

/// Values of `lanes` systems on the owned nodes, [node][component][lane]: what a kernel needs of all systems
/// lies together.
struct LaneVector {
  int nodes = 0;
  int components = 0;
  int lanes = 0;
  std::vector<double> values;

  LaneVector() = default;
  /// Zeros.
  LaneVector(int node_count, int component_count, int lane_count)
      : nodes(node_count),
        components(component_count),
        lanes(lane_count),
        values(static_cast<std::size_t>(node_count) * component_count * lane_count, 0.0) {}

  /// `unknown` = node * components + component.
  double& operator()(std::size_t unknown, int lane) { return values[unknown * lanes + lane]; }
  double operator()(std::size_t unknown, int lane) const { return values[unknown * lanes + lane]; }
  std::size_t unknowns() const { return static_cast<std::size_t>(nodes) * components; }

  std::vector<double> lane(int index) const {
    std::vector<double> result(unknowns());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = (*this)(i, index);
    return result;
  }
  void set_lane(int index, const std::vector<double>& source) {
    for (std::size_t i = 0; i < source.size(); ++i) (*this)(i, index) = source[i];
  }
};

/// A lane's solve stops at a preconditioned residual of `tolerance`, and not before the error, as the
/// spectrum lets it be estimated, is within `error_factor` times as much.
struct LaneStop {
  double tolerance = 1e-6;
  int max_iterations = 200;
  double error_factor = 2.0;
};

/// How a lane's solve ended.
struct LaneOutcome {
  int iterations = 0;
  /// |M (f - K u)| relative to |M f| or |u|, whichever is smaller, docs/formulation.md 4.1
  double residual = 0.0;
  bool converged = false;
  bool finite = true;  ///< false: something was not a number
};

}  // namespace fabseq
