// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "kernels/lane_sweep.h"

#include <array>
#include <cstddef>
#include <span>

namespace fabseq {

/// Mutual energy lambda^T K_0 u and work lambda^T f_0 of the elements, f_0 being the load of a constant
/// strain, several systems at once. Both in the basis of even and odd combinations (ParityMatrix), where K_0
/// falls apart into small blocks and f_0 has one entry per component and axis.
template <int Dim, int Width>
class ElementEnergy {
 public:
  static constexpr int corners = corner_count<Dim>;
  /// What one element contributes.
  struct Energy {
    Lanes<Width> mutual;  ///< lambda^T K_0 u
    Lanes<Width> work;    ///< lambda^T f_0
  };

  /// `stiffness`: must outlive the object. `load`: of a constant strain, [corner][component].
  ElementEnergy(const ParityMatrix<Dim, Dim>& stiffness,
                const std::array<double, element_unknowns<Dim>>& load);

  /// Calls `visit(e, energy)` for each element.
  /// \param first_corners   node of each element's lowest corner; elements next to each other along x in turn
  ///                        share the work of their face
  /// \param corner_offsets  nodes of an element's corners relative to that; along x: 1
  /// \param u,lambda        [node][component][lane], the first lane of all being the first of this object's
  /// \param lanes           in memory, at least Width
  template <class Visit>
  void for_each(std::span<const int> first_corners, const std::array<int, corners>& corner_offsets,
                const double* u, const double* lambda, int lanes, Visit&& visit) const;

 private:
  static constexpr int face_corners = corners / 2;
  using Modes = FaceModes<Dim, Dim, Width>;

  Lanes<Width> work(const Modes& lower, const Modes& upper) const;

  const ParityMatrix<Dim, Dim>& stiffness_;
  /// [component][axis]: f_0 in the mode that is odd along this axis only; it has no others.
  std::array<std::array<double, Dim>, Dim> load_{};
};

template <int Dim, int Width>
ElementEnergy<Dim, Width>::ElementEnergy(const ParityMatrix<Dim, Dim>& stiffness,
                                         const std::array<double, element_unknowns<Dim>>& load)
    : stiffness_(stiffness) {
  for (int corner = 0; corner < corners; ++corner)
    for (int a = 0; a < Dim; ++a)
      for (int axis = 0; axis < Dim; ++axis)
        load_[a][axis] += (((corner >> axis) & 1) != 0 ? -1.0 : 1.0) / corners * load[corner * Dim + a];
}

template <int Dim, int Width>
[[gnu::always_inline]] inline Lanes<Width> ElementEnergy<Dim, Width>::work(const Modes& lower,
                                                                           const Modes& upper) const {
  auto sum = Lanes<Width>::zero();
  for (int a = 0; a < Dim; ++a) {
    sum += (lower[a][0] - upper[a][0]) * load_[a][0];
    for (int axis = 1; axis < Dim; ++axis) {
      const int mode = 1 << (axis - 1);
      sum += (lower[a][mode] + upper[a][mode]) * load_[a][axis];
    }
  }
  return sum;
}

template <int Dim, int Width>
template <class Visit>
void ElementEnergy<Dim, Width>::for_each(std::span<const int> first_corners,
                                         const std::array<int, corners>& corner_offsets, const double* u,
                                         const double* lambda, int lanes, Visit&& visit) const {
  std::array<double, Width> ones;
  ones.fill(1.0);
  const ElasticKernel<Dim, Width> kernel(stiffness_, ones.data());
  const auto read = [&](const double* field, int node, Modes& modes) __attribute__((always_inline)) {
#pragma GCC unroll 4
    for (int corner = 0; corner < face_corners; ++corner) {
      const std::size_t at = static_cast<std::size_t>(node + corner_offsets[2 * corner]) * Dim;
#pragma GCC unroll 3
      for (int a = 0; a < Dim; ++a) modes[a][corner] = Lanes<Width>::load(field + (at + a) * lanes);
    }
    transform_face(modes);
  };
  Modes lower_u, upper_u, lower_lambda, upper_lambda, lower_forces, upper_forces;
  for (std::size_t e = 0; e < first_corners.size();) {
    int node = first_corners[e];
    read(u, node, lower_u);
    read(lambda, node, lower_lambda);
    do {
      ++node;
      read(u, node, upper_u);
      read(lambda, node, upper_lambda);
      kernel.template apply<1>(0, lower_u, upper_u, lower_forces, upper_forces);
      auto mutual = Lanes<Width>::zero();
#pragma GCC unroll 3
      for (int a = 0; a < Dim; ++a)
#pragma GCC unroll 4
        for (int mode = 0; mode < face_corners; ++mode)
          mutual +=
              lower_lambda[a][mode] * lower_forces[a][mode] + upper_lambda[a][mode] * upper_forces[a][mode];
      visit(e, Energy{mutual, work(lower_lambda, upper_lambda)});
      lower_u = upper_u;
      lower_lambda = upper_lambda;
      ++e;
    } while (e < first_corners.size() && first_corners[e] == node);
  }
}

}  // namespace fabseq
