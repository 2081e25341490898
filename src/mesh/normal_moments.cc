// SPDX-License-Identifier: MIT
#include "mesh/normal_moments.h"

#include "mesh/vectors.h"

namespace fabseq {

namespace {

QuadraticForm product(const LinearForm& a, const LinearForm& b) {
  return {a[0] * b[0],
          a[1] * b[1],
          a[2] * b[2],
          a[0] * b[1] + a[1] * b[0],
          a[1] * b[2] + a[2] * b[1],
          a[2] * b[0] + a[0] * b[2]};
}

CubicForm product(const QuadraticForm& q, const LinearForm& l) {
  const auto& [xx, yy, zz, xy, yz, zx] = q;
  const auto& [x, y, z] = l;
  return {xx * x,          yy * y,          zz * z,          xx * y + xy * x, xx * z + zx * x,
          yy * x + xy * y, yy * z + yz * y, zz * x + zx * z, zz * y + yz * z, xy * z + yz * x + zx * y};
}

template <std::size_t Count>
void add(std::array<double, Count>& sum, const std::array<double, Count>& term, double factor = 1.0) {
  for (std::size_t i = 0; i < Count; ++i) sum[i] += factor * term[i];
}

}  // namespace

void NormalMoments::make_harmonic() {
  auto& [xx, yy, zz, xy, yz, zx] = first;
  const double mean = (xx + yy + zz) / 3.0;
  for (double* square : {&xx, &yy, &zz}) *square -= mean;
  // |d|^2 times the Laplacian of `second`, a linear form, over 10.
  auto& [xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz] = second;
  const double x = (3.0 * xxx + yyx + zzx) / 5.0;
  const double y = (3.0 * yyy + xxy + zzy) / 5.0;
  const double z = (3.0 * zzz + xxz + yyz) / 5.0;
  for (double* with_x : {&xxx, &yyx, &zzx}) *with_x -= x;
  for (double* with_y : {&yyy, &xxy, &zzy}) *with_y -= y;
  for (double* with_z : {&zzz, &xxz, &yyz}) *with_z -= z;
}

NormalMoments moments_of_triangle(const Point<3>& a, const Point<3>& b, const Point<3>& c) {
  NormalMoments result;
  for (int axis = 0; axis < 3; ++axis) {
    result.center[axis] = (a[axis] + b[axis] + c[axis]) / 3.0;
    result.normal[axis] = 0.5 * cross(difference(b, a), difference(c, a))[axis];
  }
  result.area = norm(result.normal);
  QuadraticForm squares{};
  for (const Point<3>& corner : {a, b, c}) {
    const Point<3> u = difference(corner, result.center);
    add(squares, product(u, u), 1.0 / 12.0);
  }
  result.second = product(squares, result.normal);
  return result;
}

NormalMoments join(std::span<const NormalMoments> parts) {
  NormalMoments result;
  for (const NormalMoments& part : parts) result.area += part.area;
  for (const NormalMoments& part : parts)  // triangles may be of no area, all of them
    add(result.center, part.center,
        result.area > 0.0 ? part.area / result.area : 1.0 / static_cast<double>(parts.size()));
  for (const NormalMoments& part : parts) {
    const Point<3> shift = difference(part.center, result.center);
    const QuadraticForm shifted = product(part.normal, shift);
    add(result.normal, part.normal);
    add(result.first, part.first);
    add(result.first, shifted);
    add(result.second, part.second);
    add(result.second, product(part.first, shift), 2.0);
    add(result.second, product(shifted, shift));
  }
  return result;
}

}  // namespace fabseq
