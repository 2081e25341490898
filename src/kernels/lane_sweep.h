// SPDX-License-Identifier: MIT
/// \file
/// The matrix-free operator of many systems at once: one sweep over the elements along x.
#pragma once

#include "kernels/element_kernels.h"
#include "kernels/lane_mesh.h"

#include <algorithm>

namespace fabseq {

/// In-place Walsh-Hadamard transform of a face's corners (its own inverse up to a factor in the blocks).
template <class Modes>
[[gnu::always_inline]] inline void transform_face(Modes& face) {
  constexpr int corners = std::tuple_size_v<typename Modes::value_type>;
#pragma GCC unroll 3
  for (auto& component : face)
#pragma GCC unroll 2
    for (int step = 1; step < corners; step *= 2)
#pragma GCC unroll 4
      for (int n = 0; n < corners; ++n)
        if ((n & step) == 0) {
          const auto lower = component[n];
          const auto upper = component[n + step];
          component[n] = lower + upper;
          component[n + step] = lower - upper;
        }
}

/// The sums of one row of elements: reads faces across x, adds forces on them to the window.
template <class Kernel, class Finish>
class RowSweep {
 public:
  using Row = typename LaneMesh<Kernel::dim>::Row;
  using Number = typename Kernel::Number;
  /// Modes of so many faces, that follow each other along x, side by side.
  template <int Count>
  using Modes = typename Kernel::template Modes<Count>;

  RowSweep(const Row& row, const Kernel& kernel, const Number* x, Number* window, Finish& finish)
      : row_(row), kernel_(kernel), finish_(finish) {
    for (int corner = 0; corner < face; ++corner) {
      from_[corner] = x + row.node[corner] * node_values;
      to_[corner] = window + row.slot[corner] * node_values;
    }
  }

  /// y = K x over the row. A face's corners are transformed once and serve both of its elements, forward and
  /// back.
  [[gnu::always_inline]] void run() {
    Modes<1> even, odd, even_forces, odd_forces;
    for (auto& component : even_forces) component.fill(Value::zero());
    int i = 0;
    if constexpr (group > 1) i = pass_groups(even_forces);
    read<1>(i, node_values, even);
    // Two elements per pass: the faces change roles instead of being copied.
    for (; i + 1 < row_.length; i += 2) {
      pass(i, even, odd, even_forces, odd_forces);
      pass(i + 1, odd, even, odd_forces, even_forces);
    }
    if (i < row_.length) {
      pass(i, even, odd, even_forces, odd_forces);
      add(row_.length, odd_forces);
    } else {
      add(row_.length, even_forces);
    }
  }

 private:
  static constexpr int face = LaneMesh<Kernel::dim>::face_corners;
  static constexpr int components = Kernel::components;
  static constexpr int width = Kernel::width;
  static constexpr int node_values = components * width;
  static constexpr int cache_line = 64 / sizeof(Number);
  /// Elements side by side, whose lanes fill a register, but no more than are worth the joining.
  static constexpr int group = std::clamp(register_bytes / (width * static_cast<int>(sizeof(Number))), 1, 8);
  /// Elements from one prefetch to the next: what they read is no longer than a cache line.
  static constexpr int per_line =
      std::max(1, cache_line / std::max(node_values, static_cast<int>(Kernel::stride)));
  using Value = Lanes<width, Number>;

  /// Modes of `Count` faces, from face i on; `stride` from one to the next.
  template <int Count>
  [[gnu::always_inline]] void read(std::int64_t i, std::ptrdiff_t stride, Modes<Count>& modes) const {
#pragma GCC unroll 4
    for (int corner = 0; corner < face; ++corner)
#pragma GCC unroll 3
      for (int a = 0; a < components; ++a) {
        const Number* const place = from_[corner] + i * node_values + a * width;
        if (components == 1 && stride != 0)
          modes[a][corner] = Lanes<Count * width, Number>::load(place);
        else
          modes[a][corner] = joined_pieces<Count>([&](int k) __attribute__((always_inline)) {
            return Value::load(place + k * stride);
          });
      }
    transform_face(modes);
  }
  /// Adds forces on the corners of face i, not modes any more.
  [[gnu::always_inline]] void add_to_corners(std::int64_t i, const Modes<1>& forces) const {
    const bool last = i >= row_.finish_begin && i < row_.finish_end;
    std::array<Value, components> values;
#pragma GCC unroll 3
    for (int a = 0; a < components; ++a) {
      Number* place = to_[0] + i * node_values + a * width;
      values[a] = Value::load(place) + forces[a][0];
      (last ? Value::zero() : values[a]).store(place);
    }
#pragma GCC unroll 3
    for (int corner = 1; corner < face; ++corner)
#pragma GCC unroll 3
      for (int a = 0; a < components; ++a) {
        Number* place = to_[corner] + i * node_values + a * width;
        (Value::load(place) + forces[a][corner]).store(place);
      }
    if (last) finish_(row_.node[0] + i, values);
  }
  [[gnu::always_inline]] void add(std::int64_t i, Modes<1>& forces) const {
    transform_face(forces);
    add_to_corners(i, forces);
  }
  [[gnu::always_inline]] void prefetch(std::int64_t i) const {
    // What the next row needs and this one does not: the line behind its upper corners.
    for (int a = 0; a < node_values; a += cache_line)
      __builtin_prefetch(from_[face - 1] + (i + row_.length + 1) * node_values + a);
    kernel_.prefetch(row_.element + i + row_.length);
  }
  /// Passes element i, between faces whose modes and forces are `lower` and `upper`.
  [[gnu::always_inline]] void pass(std::int64_t i, const Modes<1>& lower, Modes<1>& upper,
                                   Modes<1>& lower_forces, Modes<1>& upper_forces) const {
    prefetch(i);
    read<1>(i + 1, node_values, upper);
    Modes<1> forces;
    kernel_.template apply<1>(row_.element + i, lower, upper, forces, upper_forces);
#pragma GCC unroll 3
    for (int a = 0; a < components; ++a)
#pragma GCC unroll 4
      for (int mode = 0; mode < face; ++mode) lower_forces[a][mode] += forces[a][mode];
    add(i, lower_forces);
  }
  /// Passes as many elements as come in whole groups; the number of these. `left`: forces of the last one on
  /// its upper face.
  [[gnu::always_inline]] int pass_groups(Modes<1>& left) const {
    if (row_.length < group) return 0;
    Modes<group> even, odd, even_forces, odd_forces;
    for (auto& component : even_forces) component.fill(Lanes<group * width, Number>::zero());
    read<group>(0, node_values, even);
    int i = 0;
    for (; i + 2 * group <= row_.length; i += 2 * group) {
      pass_group(i, even, odd, even_forces, odd_forces);
      pass_group(i + group, odd, even, odd_forces, even_forces);
    }
    if (i + group <= row_.length) {
      pass_group(i, even, odd, even_forces, odd_forces);
      i += group;
      piece_of<group - 1>(odd_forces, left);
    } else {
      piece_of<group - 1>(even_forces, left);
    }
    return i;
  }
  /// Passes elements i to i + group - 1, whose lower faces have the modes `lower`. Reads the faces behind
  /// these, `next`. `before`: forces of the group before on upper faces.
  [[gnu::always_inline]] void pass_group(std::int64_t i, const Modes<group>& lower, Modes<group>& next,
                                         const Modes<group>& before, Modes<group>& upper_forces) const {
#pragma GCC unroll 16
    for (int k = 0; k < group; k += per_line) prefetch(i + k);
    // The last group needs the first of the next faces only, and there may be no more.
    read<group>(i + group, i + 2 * group <= row_.length + 1 ? node_values : 0, next);
    Modes<group> upper, forces;
#pragma GCC unroll 3
    for (int a = 0; a < components; ++a)
#pragma GCC unroll 4
      for (int mode = 0; mode < face; ++mode)
        upper[a][mode] = lanes_from<group * width, width>(lower[a][mode], next[a][mode]);
    kernel_.template apply<group>(row_.element + i, lower, upper, forces, upper_forces);
#pragma GCC unroll 3
    for (int a = 0; a < components; ++a)
#pragma GCC unroll 4
      for (int mode = 0; mode < face; ++mode)
        forces[a][mode] +=
            lanes_from<group * width, (group - 1) * width>(before[a][mode], upper_forces[a][mode]);
    transform_face(forces);
    add_group(i, forces);
  }
  /// Adds forces on the corners of faces i to i + group - 1.
  [[gnu::always_inline]] void add_group(std::int64_t i, const Modes<group>& forces) const {
    if constexpr (components == 1)
      add_side_by_side(i, forces);
    else
      add_pieces(i, forces, std::make_integer_sequence<int, group>());
  }
  /// Adds with one component: nodes that follow each other in the row do so in memory, and finish side by
  /// side.
  [[gnu::always_inline]] void add_side_by_side(std::int64_t i, const Modes<group>& forces) const {
    using Values = Lanes<group * width, Number>;
#pragma GCC unroll 4
    for (int corner = 1; corner < face; ++corner) {
      Number* const place = to_[corner] + i * width;
      (Values::load(place) + forces[0][corner]).store(place);
    }
    Number* const place = to_[0] + i * width;
    const Values values = Values::load(place) + forces[0][0];
    if (i >= row_.finish_begin && i + group <= row_.finish_end) {
      Values::zero().store(place);
      finish_(row_.node[0] + i, std::array<Values, 1>{values});
      return;
    }
    values.store(place);
    const std::int64_t end = std::min<std::int64_t>(i + group, row_.finish_end);
    for (std::int64_t node = std::max<std::int64_t>(i, row_.finish_begin); node < end; ++node) {
      Number* const one = to_[0] + node * width;
      finish_(row_.node[0] + node, std::array<Value, 1>{Value::load(one)});
      Value::zero().store(one);
    }
  }
  template <int... K>
  [[gnu::always_inline]] void add_pieces(std::int64_t i, const Modes<group>& forces,
                                         std::integer_sequence<int, K...>) const {
    const auto add_piece = [&]<int Piece>(std::integral_constant<int, Piece>) __attribute__((always_inline)) {
      Modes<1> piece;
      piece_of<Piece>(forces, piece);
      add_to_corners(i + Piece, piece);
    };
    (add_piece(std::integral_constant<int, K>()), ...);
  }
  template <int Piece>
  [[gnu::always_inline]] static void piece_of(const Modes<group>& from, Modes<1>& piece) {
#pragma GCC unroll 3
    for (int a = 0; a < components; ++a)
#pragma GCC unroll 4
      for (int corner = 0; corner < face; ++corner)
        piece[a][corner] = lanes_from<width, Piece * width>(from[a][corner], from[a][corner]);
  }

  const Row& row_;
  const Kernel& kernel_;
  Finish& finish_;
  std::array<const Number*, face> from_;
  std::array<Number*, face> to_;
};

/// Calls `finish(node, sums)` with K x at each node, as soon as it is complete and nothing reads x there any
/// more, so that `finish` may overwrite x. `sums` is an array of Lanes by component, [lane] of one node; with
/// one component it may be of several nodes that follow each other from `node` on, [node][lane]. Its place is
/// cleared afterwards. Of shared nodes this rank's part is copied to `shared`, [position][component][lane],
/// instead. `window` has room for LaneMesh::window() nodes and is zero before and after.
template <class Kernel, class Finish>
void sweep(const LaneMesh<Kernel::dim>& mesh, const Kernel& kernel, const typename Kernel::Number* x,
           typename Kernel::Number* window, typename Kernel::Number* shared, Finish&& finish) {
  constexpr int width = Kernel::width;
  constexpr int components = Kernel::components;
  constexpr int node_values = components * width;
  using Number = typename Kernel::Number;
  using Value = Lanes<width, Number>;
  for (const auto& line : mesh.lines()) {
    for (int row = line.first_row; row < line.last_row; ++row)
      RowSweep(mesh.rows()[row], kernel, x, window, finish).run();
    for (int s = line.first_segment; s < line.last_segment; ++s) {
      const auto& segment = mesh.segments()[s];
      Number* sums = window + segment.slot * node_values;
      for (int i = 0; i < segment.length; ++i, sums += node_values) {
        std::array<Value, components> values;
        for (int a = 0; a < components; ++a) {
          values[a] = Value::load(sums + a * width);
          Value::zero().store(sums + a * width);
        }
        if (segment.shared < 0)
          finish(segment.node + i, values);
        else
          for (int a = 0; a < components; ++a)
            values[a].store(shared + (segment.shared + i) * node_values + a * width);
      }
    }
  }
}

}  // namespace fabseq
