// SPDX-License-Identifier: MIT
/// The rotation that turns a torch (docs/developer/derivatives.md 13.2).
#include "fabseq/machine/least_rotation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

Point<3> unit(double x, double y, double z) {
  const double length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}

TEST(LeastRotationTest, TakesUpToTheAxisAndKeepsLengths) {
  const Point<3> up = {0.0, 0.0, 1.0};
  for (const Point<3>& axis : {unit(0.3, -0.2, 0.9), unit(1.0, 2.0, -0.5), up}) {
    const LeastRotation<3> rotation(up, axis);
    const Point<3> image = rotation.apply(up), p = {0.4, -1.3, 0.7}, q = {-0.2, 0.6, 1.1};
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(image[i], axis[i], 1e-5);
    EXPECT_NEAR(dot(rotation.apply(p), rotation.apply(q)), dot(p, q), 1e-5);
    // What is perpendicular to both stays: no other rotation turns less.
    const Point<3> across = {-axis[1], axis[0], 0.0}, moved = rotation.apply(across);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(moved[i], across[i], 1e-5);
  }
}

TEST(LeastRotationTest, DerivativeByTheAxis) {
  const Point<3> up = {0.0, 0.0, 1.0}, axis = unit(0.3, -0.8, 0.4), point = {0.4, -1.3, 0.7},
                 d_image = {0.9, 0.2, -0.6};
  Point<3> d_axis{};
  LeastRotation<3>(up, axis).add_derivative(point, d_image, d_axis);
  constexpr double step = 1e-5;
  for (int i = 0; i < 3; ++i) {
    Point<3> ahead = axis, behind = axis;
    ahead[i] += step;
    behind[i] -= step;
    const double difference = dot(LeastRotation<3>(up, ahead).apply(point), d_image) -
                              dot(LeastRotation<3>(up, behind).apply(point), d_image);
    EXPECT_NEAR(d_axis[i], difference / (2.0 * step), 1e-8);
  }
}

}  // namespace
}  // namespace fabseq
