// SPDX-License-Identifier: MIT
#include "fabseq/part/shape.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fabseq {

namespace {

/// A point; in 2D the third entry is 0. It lives on the stack because this runs for every element and node of
/// the grid.
using Offset = std::array<double, 3>;

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) sum += a[i] * b[i];
  return sum;
}

double norm(std::span<const double> a) { return std::sqrt(dot(a, a)); }

Offset difference_of(std::span<const double> a, std::span<const double> b) {
  Offset result{};
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

bool in_box(const Shape& box, std::span<const double> point, double tolerance) {
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (point[i] < box.first[i] - tolerance || point[i] > box.second[i] + tolerance) return false;
  }
  return true;
}

bool in_half_space(const Shape& half_space, std::span<const double> point, double tolerance) {
  return dot(difference_of(point, half_space.first), half_space.second) <=
         tolerance * norm(half_space.second);
}

bool in_sphere(const Shape& sphere, std::span<const double> point, double tolerance) {
  return norm(difference_of(point, sphere.first)) <= sphere.radius + tolerance;
}

bool in_cylinder(const Shape& cylinder, std::span<const double> point, double tolerance) {
  const Offset axis = difference_of(cylinder.second, cylinder.first);
  Offset offset = difference_of(point, cylinder.first);
  const double length = norm(axis);
  const double along = dot(offset, axis) / length;
  if (along < -tolerance || along > length + tolerance) return false;
  for (std::size_t i = 0; i < offset.size(); ++i) offset[i] -= along * axis[i] / length;
  return norm(offset) <= cylinder.radius + tolerance;
}

bool in_polygon(const Shape& shape, std::span<const double> point, double tolerance) {
  Polygon::Point projected{};
  std::size_t next = 0;
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (point.size() == 3 && static_cast<int>(i) == shape.axis) continue;
    projected[next++] = point[i];
  }
  return shape.polygon.contains(projected, tolerance);
}

}  // namespace

bool Shape::contains(std::span<const double> point, double tolerance) const {
  const auto holds_point = [&](const Shape& operand) { return operand.contains(point, tolerance); };
  switch (kind) {
    case Kind::box:
      return in_box(*this, point, tolerance);
    case Kind::half_space:
      return in_half_space(*this, point, tolerance);
    case Kind::cylinder:
      return in_cylinder(*this, point, tolerance);
    case Kind::sphere:
      return in_sphere(*this, point, tolerance);
    case Kind::polygon:
      return in_polygon(*this, point, tolerance);
    case Kind::union_of:
      return std::any_of(operands.begin(), operands.end(), holds_point);
    case Kind::intersection:
      return std::all_of(operands.begin(), operands.end(), holds_point);
    case Kind::difference:
      return holds_point(operands.front()) && std::none_of(operands.begin() + 1, operands.end(), holds_point);
  }
  return false;
}

}  // namespace fabseq
