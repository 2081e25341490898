// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/lanes/lane_array.h"
#include "fabseq/lanes/lane_hierarchy.h"
#include "fabseq/lanes/lane_problem.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

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
    const LaneMesh<Problem::dim>& mesh = level.mesh;
    std::vector<unsigned char> held(static_cast<std::size_t>(mesh.nodes()), 0);  // a bit per component
    for (const std::int64_t unknown : level.fixed) held[unknown / components] |= 1U << (unknown % components);
    inverse_.resize(static_cast<std::size_t>(mesh.nodes()) * block);
    LaneArray window(static_cast<std::size_t>(mesh.window()) * block, 0.0);
    LaneArray shared(level.shared.nodes().size() * block);
    const auto finish = [&](std::int64_t node, double* sums) {
      invert(sums, held[node], &inverse_[node * block]);
      std::fill_n(sums, block, 0.0);
    };
    for (const auto& line : mesh.lines()) {
      for (int number = line.first_row; number < line.last_row; ++number) {
        const auto& row = mesh.rows()[number];
        add(row, matrices, coefficients, window.data());
        for (int i = row.finish_begin; i < row.finish_end; ++i)
          finish(row.node[0] + i, &window[(row.slot[0] + i) * block]);
      }
      for (int number = line.first_segment; number < line.last_segment; ++number) {
        const auto& segment = mesh.segments()[number];
        for (int i = 0; i < segment.length; ++i) {
          double* const sums = &window[(segment.slot + i) * block];
          if (segment.shared < 0) {
            finish(segment.node + i, sums);
          } else {
            std::copy_n(sums, block, &shared[(segment.shared + i) * block]);
            std::fill_n(sums, block, 0.0);
          }
        }
      }
    }
    if (!level.distributed) return;
    level.shared.sum(std::span<double>(shared), block);
    for (std::size_t i = 0; i < level.shared.nodes().size(); ++i)
      finish(level.shared.nodes()[i], &shared[i * block]);
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
    const float* own = inverse_.data() + node * block;
    Values result;
    for (int a = 0; a < components; ++a) {
      result[a] = load(own + a * width) * values[a];
      for (int b = 0; b < components; ++b)
        if (b != a) result[a] += load(own + off_diagonal(a, b) * width) * values[b];
    }
    return result;
  }
  void prefetch(std::int64_t node) const {
    for (int i = 0; i < block; i += 16) __builtin_prefetch(inverse_.data() + node * block + i);
  }

 private:
  template <class, int, class>
  friend class NodeScaling;

  static constexpr int block = entries * width;

  static constexpr int off_diagonal(int a, int b) { return a == b ? a : components + a + b - 1; }
  [[gnu::always_inline]] static Lanes<Width, Real> load(const float* from) {
    if constexpr (Problem::own_operators)
      return Lanes<Width, Real>::load(from);
    else
      return Lanes<Width, Real>::broadcast(*from);
  }
  /// Adds up the blocks of a row's elements in the window.
  void add(const typename LaneMesh<Problem::dim>::Row& row, const typename Problem::Matrices& matrices,
           const Real* coefficients, double* window) const {
    constexpr int stride = Problem::template Kernel<Width>::stride;
    for (int i = 0; i < row.length; ++i) {
      const Real* of_element = coefficients + (row.element + i) * stride;
      for (int corner = 0; corner < corner_count<Problem::dim>; ++corner) {
        double* place = window + (row.slot[corner / 2] + i + corner % 2) * block;
        for (int a = 0; a < components; ++a)
          for (int b = a; b < components; ++b)
            for (int lane = 0; lane < width; ++lane)
              place[off_diagonal(a, b) * width + lane] += Problem::template entry<Width>(
                  matrices, corner * components + a, corner * components + b, of_element, lane);
      }
    }
  }

  /// Held unknowns count as unit rows while inverting.
  void invert(const double* sums, unsigned held, float* inverse) const {
    using Value = Lanes<width>;
    const auto is_held = [&](int a, int b) { return (((held >> a) | (held >> b)) & 1U) != 0; };
    const auto entry = [&](int a, int b) {
      if (is_held(a, b)) return Value::broadcast(a == b ? 1.0 : 0.0);
      return Value::load(sums + off_diagonal(a, b) * width);
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
