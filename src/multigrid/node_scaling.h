// SPDX-License-Identifier: MIT
#pragma once

#include "kernels/lane_array.h"
#include "kernels/lane_problem.h"
#include "multigrid/lane_hierarchy.h"

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
    inverse_.resize(static_cast<std::size_t>(level.mesh.nodes()) * block);
    LaneArray shared(level.shared.nodes().size() * block);  // parts of their blocks
    std::vector<unsigned char> held(static_cast<std::size_t>(level.mesh.nodes()), 0);  // a bit per component
    for (const std::int64_t unknown : level.fixed) held[unknown / components] |= 1U << (unknown % components);
    const auto& shared_nodes = level.shared.nodes();
    std::size_t next = 0;  // among these: both ascend
    const std::vector<double> diagonal = diagonal_of_rows(level.mesh, matrices, coefficients);
    for (const auto& run : level.mesh.node_runs())
      for (std::int64_t node = run.node; node < run.node + run.length; ++node) {
        Index<Problem::dim> index = run.index;
        index[0] += static_cast<int>(node - run.node);
        Sums sums;
        if constexpr (block == 1)
          sums = load_sums(&diagonal[node]);
        else
          sums = sums_of_elements(level.mesh, index, matrices, coefficients);
        if (next < shared_nodes.size() && shared_nodes[next] == node)
          store(sums, &shared[next++ * block]);
        else
          invert(sums, held[node], &inverse_[node * block]);
      }
    if (!level.distributed) return;
    level.shared.sum(std::span<double>(shared), block);
    for (std::size_t i = 0; i < shared_nodes.size(); ++i)
      invert(load_sums(&shared[i * block]), held[shared_nodes[i]], &inverse_[shared_nodes[i] * block]);
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
  /// `values`: of a node or, with one component, of several from `node` on.
  template <class Value>
  [[gnu::always_inline]] std::array<Value, components> apply(
      std::int64_t node, const std::array<Value, components>& values) const {
    const float* own = inverse_.data() + node * block;
    std::array<Value, components> result;
    for (int a = 0; a < components; ++a) {
      result[a] = load<Value>(own + a * width) * values[a];
      for (int b = 0; b < components; ++b)
        if (b != a) result[a] += load<Value>(own + off_diagonal(a, b) * width) * values[b];
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
  using Sums = std::array<Lanes<width>, entries>;

  static constexpr int off_diagonal(int a, int b) { return a == b ? a : components + a + b - 1; }
  template <class Value>
  [[gnu::always_inline]] static Value load(const float* from) {
    if constexpr (Problem::own_operators || Width == 1)
      return Value::load(from);
    else
      return joined_pieces<Value::width / Width>([&](int k) __attribute__((always_inline)) {
        return Lanes<Width, Real>::broadcast(from[k]);
      });
  }
  /// Returns the diagonal of one component that all lanes share; empty for others. Along the rows this takes
  /// a fifth of the time that a search for each node's elements does.
  static std::vector<double> diagonal_of_rows(const LaneMesh<Problem::dim>& mesh,
                                              const typename Problem::Matrices& matrices,
                                              const Real* coefficients) {
    std::vector<double> result;
    if constexpr (block == 1) {
      constexpr int stride = Problem::template Kernel<Width>::stride;
      result.resize(static_cast<std::size_t>(mesh.nodes()));
      for (const auto& row : mesh.rows())
        for (int corner = corner_count<Problem::dim> - 1; corner >= 0; --corner) {  // ascending elements
          double* const sums = &result[row.node[corner / 2] + corner % 2];
          const Real* const own = coefficients + row.element * stride;
          for (int i = 0; i < row.length; ++i)
            sums[i] += Problem::template entries<Width>(matrices, corner, corner, own + i * stride)[0];
        }
    }
    return result;
  }
  /// A node's block, of this rank's elements around it.
  Sums sums_of_elements(const LaneMesh<Problem::dim>& mesh, const Index<Problem::dim>& node,
                        const typename Problem::Matrices& matrices, const Real* coefficients) const {
    constexpr int stride = Problem::template Kernel<Width>::stride;
    Sums sums;
    sums.fill(Lanes<width>::zero());
    for (int corner = corner_count<Problem::dim> - 1; corner >= 0; --corner) {  // ascending elements
      const Index<Problem::dim> element = stepped<Problem::dim>(node, corner, -1);
      const int number = mesh.element_box().contains(element) ? mesh.element_number(element) : -1;
      if (number < 0) continue;
      const Real* const own = coefficients + static_cast<std::int64_t>(number) * stride;
      for (int a = 0; a < components; ++a)
        for (int b = a; b < components; ++b)
          sums[off_diagonal(a, b)] += Problem::template entries<Width>(matrices, corner * components + a,
                                                                       corner * components + b, own);
    }
    return sums;
  }
  static void store(const Sums& sums, double* to) {
    for (int i = 0; i < entries; ++i) sums[i].store(to + i * width);
  }
  static Sums load_sums(const double* from) {
    Sums sums;
    for (int i = 0; i < entries; ++i) sums[i] = Lanes<width>::load(from + i * width);
    return sums;
  }

  /// Held unknowns count as unit rows while inverting.
  void invert(const Sums& sums, unsigned held, float* inverse) const {
    using Value = Lanes<width>;
    const auto is_held = [&](int a, int b) { return (((held >> a) | (held >> b)) & 1U) != 0; };
    const auto entry = [&](int a, int b) {
      if (is_held(a, b)) return Value::broadcast(a == b ? 1.0 : 0.0);
      return sums[off_diagonal(a, b)];
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
