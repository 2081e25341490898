// SPDX-License-Identifier: MIT
/// \file
/// Flops and bytes of the element kernels.
#pragma once

#include "fabseq/fem/parity.h"
#include "kernels/lane_mesh.h"
#include "kernels/lane_problem.h"

namespace benchmarks {

/// Of one call. Whatever is 0 is not reported.
struct Cost {
  double unknowns = 0.0;  ///< node x component x lane
  /// Least traffic that the algorithm needs if every array is too large for the caches: what it reads once,
  /// what it writes once, without write-allocate, like the triad.
  double bytes = 0.0;
  double flops = 0.0;  ///< additions and multiplications as the source has them; a multiply-add is two
};

/// Flops that the blocks of an element matrix take, a lane: an element of ElasticKernel without its
/// transforms.
template <int Dim>
constexpr double block_flops() {
  double flops = 0.0;
  for (int parity_class = 0; parity_class < fabseq::corner_count<Dim>; ++parity_class)
    for (int a = 0; a < Dim; ++a) {
      int terms = 0;
      for (int b = 0; b < Dim; ++b)
        if (fabseq::ParityMatrix<Dim, Dim>::couples(parity_class, a, b)) ++terms;
      if (terms > 0) flops += 2 * terms - 1;
    }
  // A face class a component: even and odd combination, twice the factor, three additions.
  return flops + fabseq::corner_count<Dim> / 2 * Dim * 7;
}

/// A face's transform forward and back, and its addition to the window; every element has a face of its own.
template <int Dim, int Components>
constexpr double face_flops() {
  constexpr int face = fabseq::corner_count<Dim> / 2;
  return Components * face * (2 * (Dim - 1) + 1);
}

/// Flops an element and lane.
template <class Problem, int Width>
constexpr double element_flops() {
  constexpr int dim = Problem::dim;
  constexpr int modes = fabseq::corner_count<dim>;
  double flops = face_flops<dim, Problem::components>();
  if constexpr (Problem::own_operators)
    flops += block_flops<dim>();
  else  // 7 a pair of modes; the matrix's entries, 3 each, serve all lanes
    flops += 3.5 * modes + 3.0 * modes / Width;
  return flops;
}

/// Of y = K x on a mesh: x, y and the elements' coefficients pass once.
template <class Problem, int Width, class Real = double>
Cost operator_cost(const fabseq::LaneMesh<Problem::dim>& mesh) {
  const auto elements = static_cast<double>(mesh.elements());
  Cost cost;
  cost.unknowns = static_cast<double>(mesh.nodes()) * Problem::components * Width;
  constexpr int stride = Problem::template Kernel<Width, Real>::stride;
  cost.bytes = sizeof(Real) * (2 * cost.unknowns + stride * elements);
  cost.flops = element_flops<Problem, Width>() * Width * elements;
  return cost;
}

/// What a core can do at most, an unknown: 26.7 bytes (x, y, a third of a coefficient, and y once more, since
/// it is fetched before it is written; a kernel that writes past the caches is better than that) and 80 flops
/// for elasticity in 3D; elsewhere as counted.
template <class Problem>
Cost limiting_cost(const Cost& counted) {
  if (Problem::own_operators && Problem::dim == 3) return {1.0, 26.7, 80.0};
  return {1.0, counted.bytes / counted.unknowns + sizeof(double), counted.flops / counted.unknowns};
}

}  // namespace benchmarks
