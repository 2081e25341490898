// SPDX-License-Identifier: MIT
/// \file
/// The matrix-free operator of many systems at once: one sweep over the elements along x.
#pragma once

#include "fabseq/lanes/element_kernels.h"
#include "fabseq/lanes/lane_mesh.h"

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

/// Begins sweep_row for one system with one unknown per node: elements of the row take the places of the
/// lanes. Passes as many as come in whole registers; the number of these.
template <class Kernel, class Finish>
[[gnu::always_inline]] inline int sweep_across(const typename LaneMesh<Kernel::dim>::Row& row,
                                               const Kernel& kernel, const typename Kernel::Number* x,
                                               typename Kernel::Number* window, Finish& finish) {
  using Number = typename Kernel::Number;
  constexpr int face = LaneMesh<Kernel::dim>::face_corners;
  constexpr int count = register_bytes / static_cast<int>(sizeof(Number));
  using Value = Lanes<count, Number>;
  using Modes = FaceModes<Kernel::dim, 1, count, Number>;
  std::array<Value, face> before;  // forces of the elements before on their upper faces
  before.fill(Value::zero());
  int i = 0;
  for (; i + count <= row.length; i += count) {
    Modes lower, upper, lower_forces, upper_forces;
#pragma GCC unroll 4
    for (int corner = 0; corner < face; ++corner) {
      lower[0][corner] = Value::load(x + row.node[corner] + i);
      upper[0][corner] = Value::load(x + row.node[corner] + i + 1);
    }
    transform_face(lower);
    transform_face(upper);
    kernel.template apply_across<count>(row.element + i, lower, upper, lower_forces, upper_forces);
    transform_face(lower_forces);
    transform_face(upper_forces);
#pragma GCC unroll 4
    for (int corner = 0; corner < face; ++corner) {
      Number* const place = window + row.slot[corner] + i;
      const auto forces = lower_forces[0][corner] + shifted(before[corner], upper_forces[0][corner]);
      before[corner] = upper_forces[0][corner];
      (Value::load(place) + forces).store(place);
    }
    for (int node = std::max(i, row.finish_begin); node < std::min(i + count, row.finish_end); ++node) {
      Number& sum = window[row.slot[0] + node];
      finish(row.node[0] + node, std::array<Lanes<1, Number>, 1>{Lanes<1, Number>{sum}});
      sum = Number{0};
    }
  }
  for (int corner = 0; corner < face; ++corner) window[row.slot[corner] + i] += before[corner][count - 1];
  return i;
}

/// y = K x over a row of elements, added to the window; calls `finish` for the nodes that the row finishes. A
/// face's corners are transformed once and serve both of its elements, forward and back.
template <class Kernel, class Finish>
[[gnu::always_inline]] inline void sweep_row(const typename LaneMesh<Kernel::dim>::Row& row,
                                             const Kernel& kernel, const typename Kernel::Number* x,
                                             typename Kernel::Number* window, Finish& finish) {
  constexpr int face = LaneMesh<Kernel::dim>::face_corners;
  constexpr int components = Kernel::components;
  constexpr int width = Kernel::width;
  constexpr int node_values = components * width;
  using Number = typename Kernel::Number;
  using Value = Lanes<width, Number>;
  constexpr int cache_line = 64 / sizeof(Number);
  using Modes = typename Kernel::Modes;
  std::array<const Number*, face> from;
  std::array<Number*, face> to;
  for (int corner = 0; corner < face; ++corner) {
    from[corner] = x + row.node[corner] * node_values;
    to[corner] = window + row.slot[corner] * node_values;
  }
  const auto read = [&](std::int64_t i, Modes & modes) __attribute__((always_inline)) {
#pragma GCC unroll 4
    for (int corner = 0; corner < face; ++corner)
#pragma GCC unroll 3
      for (int a = 0; a < components; ++a)
        modes[a][corner] = Value::load(from[corner] + i * node_values + a * width);
    transform_face(modes);
  };
  const auto add = [&](std::int64_t i, Modes & forces) __attribute__((always_inline)) {
    transform_face(forces);
    const bool last = i >= row.finish_begin && i < row.finish_end;
    std::array<Value, components> values;
#pragma GCC unroll 3
    for (int a = 0; a < components; ++a) {
      Number* place = to[0] + i * node_values + a * width;
      values[a] = Value::load(place) + forces[a][0];
      (last ? Value::zero() : values[a]).store(place);
    }
#pragma GCC unroll 3
    for (int corner = 1; corner < face; ++corner)
#pragma GCC unroll 3
      for (int a = 0; a < components; ++a) {
        Number* place = to[corner] + i * node_values + a * width;
        (Value::load(place) + forces[a][corner]).store(place);
      }
    if (last) finish(row.node[0] + i, values);
  };
  // Passes element i, between faces whose modes and forces are `lower` and `upper`.
  const auto pass = [&](std::int64_t i, const Modes& lower, Modes& upper, Modes& lower_forces,
                        Modes& upper_forces) __attribute__((always_inline)) {
    // What the next row needs and this one does not: the line behind its upper corners.
    for (int a = 0; a < node_values; a += cache_line)
      __builtin_prefetch(from[face - 1] + (i + row.length + 1) * node_values + a);
    kernel.prefetch(row.element + i + row.length);
    read(i + 1, upper);
    kernel.apply(row.element + i, lower, upper, lower_forces, upper_forces);
    add(i, lower_forces);
  };
  // Two elements per pass: the faces change roles instead of being copied.
  int i = 0;
  if constexpr (width == 1 && components == 1) i = sweep_across(row, kernel, x, window, finish);
  Modes even, odd, even_forces, odd_forces;
  read(i, even);
  for (auto& component : even_forces) component.fill(Value::zero());
  for (; i + 1 < row.length; i += 2) {
    pass(i, even, odd, even_forces, odd_forces);
    pass(i + 1, odd, even, odd_forces, even_forces);
  }
  if (i < row.length) {
    pass(i, even, odd, even_forces, odd_forces);
    add(row.length, odd_forces);
  } else {
    add(row.length, even_forces);
  }
}

/// Calls `finish(node, sums)` with K x at each node, as soon as it is complete and nothing reads x there any
/// more, so that `finish` may overwrite x; `sums` is [component][lane], its place is cleared afterwards. Of
/// shared nodes this rank's part is copied to `shared`, [position][component][lane], instead. `window` has
/// room for LaneMesh::window() nodes and is zero before and after.
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
      sweep_row(mesh.rows()[row], kernel, x, window, finish);
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
