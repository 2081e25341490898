// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq {

/// The most systems, layers or right-hand sides, that the lane solvers take side by side.
inline constexpr int widest_block = 8;

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

/// Gives `vector` this size. Its values are left to whoever sets them: the memory of a block of layers serves
/// the next one, too, for fresh memory costs more than what is done with it.
void resize(LaneVector& vector, int nodes, int components, int lanes);
/// Sets `some` to the values of these nodes, times a factor.
void pick(const LaneVector& all, std::span<const int> nodes, LaneVector& some, double factor = 1.0);
/// The other way round, with 0 at other nodes; `all` has `count` nodes.
void spread(const LaneVector& some, std::span<const int> nodes, int count, LaneVector& all);

}  // namespace fabseq
