// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/grid/index_box.h"

#include <array>
#include <span>

namespace fabseq {

/// Coefficients of homogeneous polynomials in d = (x, y, z), in the order of the comments.
using LinearForm = std::array<double, 3>;     ///< x y z
using QuadraticForm = std::array<double, 6>;  ///< xx yy zz xy yz zx
using CubicForm = std::array<double, 10>;     ///< xxx yyy zzz xxy xxz yyx yyz zzx zzy xyz

/// Moments of the normals n of triangles about a point c, as polynomials in d: integrals over the area with
/// u = x - c. They are what the Taylor expansion of the winding number needs (Barill et al. 2018, section 3).
struct NormalMoments {
  double area = 0.0;
  Point<3> center{};      ///< c, the triangles' centroid
  LinearForm normal{};    ///< integral of n . d
  QuadraticForm first{};  ///< integral of (n . d)(u . d)
  CubicForm second{};     ///< integral of (n . d)(u . d)^2

  /// Removes what contributes nothing: the parts of `first` and `second` that are multiples of |d|^2, since
  /// they meet derivatives of 1 / |d|, a harmonic function.
  void make_harmonic();
};

/// Exact moments of a triangle; its corners run counterclockwise around n.
NormalMoments moments_of_triangle(const Point<3>& a, const Point<3>& b, const Point<3>& c);
/// Moments of several sets of triangles together, about the centroid of all of them.
NormalMoments join(std::span<const NormalMoments> parts);

}  // namespace fabseq
