// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/lanes/lane_array.h"
#include "fabseq/lanes/lane_hierarchy.h"
#include "fabseq/lanes/lane_problem.h"

#include <algorithm>

namespace fabseq {

/// What the smoother scales residuals with: the inverse of a node's block of the operator, `components` wide,
/// symmetric; zero for held unknowns, so that whatever is scaled with it stays zero there. Kept in single
/// precision: it need not be exact, only symmetric, positive and always the same. Problems whose lanes share
/// the operator have one block for all. `Real`: of the coefficients and of what is scaled.
template <class Problem, int Width, class Real = double>
class NodeScaling {
 public:
  static constexpr int components = Problem::components;
  static constexpr int width = Problem::template operators<Width>;
  /// Entries of a symmetric block: diagonal first, then (0,1), (0,2), (1,2).
  static constexpr int entries = components * (components + 1) / 2;

  /// `coefficients` as the problem's kernel takes them. Collective on the level's communicator.
  void set_up(LaneLevel<Problem::dim>& level, const typename Problem::Matrices& matrices,
              const Real* coefficients) {
    constexpr int block = entries * width;
    LaneArray blocks(static_cast<std::size_t>(level.mesh.nodes()) * block, 0.0);
    collect(level, matrices, coefficients, blocks);
    sum_over_holders(level, blocks.data(), block);
    inverse_.resize(blocks.size());
    std::size_t next = 0;  // among the held unknowns
    for (std::int64_t node = 0; node < level.mesh.nodes(); ++node) {
      unsigned held = 0;
      for (; next < level.fixed.size() && level.fixed[next] / components == node; ++next)
        held |= 1U << (level.fixed[next] % components);
      invert(&blocks[node * block], held, &inverse_[node * block]);
    }
  }

  /// Takes over lanes of a wider one.
  template <int Wider>
  void select(const NodeScaling<Problem, Wider, Real>& from, std::span<const int> lanes) {
    if constexpr (Problem::own_operators)
      select_lanes(from.inverse_, Wider, lanes, inverse_, Width);
    else
      inverse_ = from.inverse_;
  }

  using Values = std::array<Lanes<Width, Real>, components>;
  [[gnu::always_inline]] Values apply(std::int64_t node, const Values& values) const {
    const float* block = inverse_.data() + node * entries * width;
    Values result;
    for (int a = 0; a < components; ++a) {
      result[a] = load(block + a * width) * values[a];
      for (int b = 0; b < components; ++b)
        if (b != a) result[a] += load(block + off_diagonal(a, b) * width) * values[b];
    }
    return result;
  }
  void prefetch(std::int64_t node) const {
    const float* block = inverse_.data() + node * entries * width;
    for (int i = 0; i < entries * width; i += 16) __builtin_prefetch(block + i);
  }

 private:
  template <class, int, class>
  friend class NodeScaling;

  static constexpr int off_diagonal(int a, int b) { return a == b ? a : components + a + b - 1; }
  [[gnu::always_inline]] static Lanes<Width, Real> load(const float* from) {
    if constexpr (Problem::own_operators)
      return Lanes<Width, Real>::load(from);
    else
      return Lanes<Width, Real>::broadcast(*from);
  }
  void collect(const LaneLevel<Problem::dim>& level, const typename Problem::Matrices& matrices,
               const Real* coefficients, LaneArray& blocks) const {
    constexpr int stride = Problem::template Kernel<Width>::stride;
    constexpr int corners = corner_count<Problem::dim>;
    for (const auto& row : level.mesh.rows())
      for (int i = 0; i < row.length; ++i) {
        const Real* of_element = coefficients + (row.element + i) * stride;
        for (int corner = 0; corner < corners; ++corner) {
          double* place = &blocks[(row.node[corner / 2] + i + corner % 2) * entries * width];
          for (int a = 0; a < components; ++a)
            for (int b = a; b < components; ++b)
              for (int lane = 0; lane < width; ++lane)
                place[off_diagonal(a, b) * width + lane] += Problem::template entry<Width>(
                    matrices, corner * components + a, corner * components + b, of_element, lane);
        }
      }
  }

  /// Held unknowns count as unit rows while inverting.
  void invert(const double* block, unsigned held, float* inverse) const {
    using Value = Lanes<width>;
    const auto is_held = [&](int a, int b) { return (((held >> a) | (held >> b)) & 1U) != 0; };
    const auto entry = [&](int a, int b) {
      if (is_held(a, b)) return Value::broadcast(a == b ? 1.0 : 0.0);
      return Value::load(block + off_diagonal(a, b) * width);
    };
    const auto set = [&](int a, int b, const Value& value) {
      float* place = inverse + off_diagonal(a, b) * width;
      for (int lane = 0; lane < width; ++lane)
        place[lane] = is_held(a, b) ? 0.0F : static_cast<float>(value[lane]);
    };
    const Value one = Value::broadcast(1.0);
    if constexpr (components == 1) {
      set(0, 0, one / entry(0, 0));
    } else if constexpr (components == 2) {
      const Value scale = one / (entry(0, 0) * entry(1, 1) - entry(0, 1) * entry(0, 1));
      set(0, 0, entry(1, 1) * scale);
      set(1, 1, entry(0, 0) * scale);
      set(0, 1, entry(0, 1) * scale * -1.0);
    } else {
      const Value a = entry(0, 0), b = entry(1, 1), c = entry(2, 2);
      const Value d = entry(0, 1), e = entry(0, 2), f = entry(1, 2);
      const Value scale = one / (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e));
      set(0, 0, (b * c - f * f) * scale);
      set(1, 1, (a * c - e * e) * scale);
      set(2, 2, (a * b - d * d) * scale);
      set(0, 1, (e * f - d * c) * scale);
      set(0, 2, (d * f - b * e) * scale);
      set(1, 2, (d * e - a * f) * scale);
    }
  }

  LaneValues<float> inverse_;  ///< [node][entry][lane]
};

}  // namespace fabseq
