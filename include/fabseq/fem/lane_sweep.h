/// \file
/// The matrix-free operator of many systems at once: one sweep over the elements along x.
#pragma once

#include "fabseq/fem/element_kernels.h"
#include "fabseq/fem/lane_mesh.h"

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

/// y = K x over a row of elements, added to the window. A face's corners are transformed once and serve both
/// of its elements, forward and back.
template <class Kernel>
[[gnu::always_inline]] inline void sweep_row(const typename LaneMesh<Kernel::dim>::Row& row,
                                             const Kernel& kernel, const double* x, double* window) {
  constexpr int face = LaneMesh<Kernel::dim>::face_corners;
  constexpr int components = Kernel::components;
  constexpr int width = Kernel::width;
  constexpr int block = components * width;
  constexpr int cache_line = 64 / sizeof(double);
  using Modes = typename Kernel::Modes;
  std::array<const double*, face> from;
  std::array<double*, face> to;
  for (int corner = 0; corner < face; ++corner) {
    from[corner] = x + row.node[corner] * block;
    to[corner] = window + row.slot[corner] * block;
  }
  const auto read = [&](std::int64_t i, Modes & modes) __attribute__((always_inline)) {
#pragma GCC unroll 4
    for (int corner = 0; corner < face; ++corner)
#pragma GCC unroll 3
      for (int a = 0; a < components; ++a)
        modes[a][corner] = Lanes<width>::load(from[corner] + i * block + a * width);
    transform_face(modes);
  };
  const auto add = [&](std::int64_t i, Modes & forces) __attribute__((always_inline)) {
    transform_face(forces);
#pragma GCC unroll 4
    for (int corner = 0; corner < face; ++corner)
#pragma GCC unroll 3
      for (int a = 0; a < components; ++a) {
        double* place = to[corner] + i * block + a * width;
        (Lanes<width>::load(place) + forces[a][corner]).store(place);
      }
  };
  Modes lower, upper, lower_forces, upper_forces;
  read(0, lower);
  for (auto& component : lower_forces) component.fill(Lanes<width>::zero());
  for (int i = 0; i < row.length; ++i) {
    // What the next row needs and this one does not: the line behind its upper corners.
    for (int a = 0; a < block; a += cache_line)
      __builtin_prefetch(from[face - 1] + (i + row.length + 1) * block + a);
    kernel.prefetch(row.element + i + row.length);
    read(i + 1, upper);
    kernel.apply(row.element + i, lower, upper, lower_forces, upper_forces);
    add(i, lower_forces);
    lower = upper;
    lower_forces = upper_forces;
  }
  add(row.length, lower_forces);
}

/// Calls `finish(node, sums)` with K x at each node, as soon as it is complete and nothing reads x there any
/// more, so that `finish` may overwrite x; `sums` is [component][lane], its place is cleared afterwards. Of
/// shared nodes this rank's part is copied to `shared`, [position][component][lane], instead. `window` has
/// room for LaneMesh::window() nodes and is zero before and after.
template <class Kernel, class Finish>
void sweep(const LaneMesh<Kernel::dim>& mesh, const Kernel& kernel, const double* x, double* window,
           double* shared, Finish&& finish) {
  constexpr int width = Kernel::width;
  constexpr int components = Kernel::components;
  constexpr int block = components * width;
  for (const auto& line : mesh.lines()) {
    for (int row = line.first_row; row < line.last_row; ++row) sweep_row(mesh.rows()[row], kernel, x, window);
    for (int s = line.first_segment; s < line.last_segment; ++s) {
      const auto& segment = mesh.segments()[s];
      double* sums = window + segment.slot * block;
      for (int i = 0; i < segment.length; ++i, sums += block) {
        std::array<Lanes<width>, components> values;
        for (int a = 0; a < components; ++a) {
          values[a] = Lanes<width>::load(sums + a * width);
          Lanes<width>::zero().store(sums + a * width);
        }
        if (segment.shared < 0)
          finish(segment.node + i, values);
        else
          for (int a = 0; a < components; ++a)
            values[a].store(shared + (segment.shared + i) * block + a * width);
      }
    }
  }
}

}  // namespace fabseq
