// SPDX-License-Identifier: MIT
/// Points that fill a torch, and the rotation that turns them (docs/formulation.md 13.2).
#include "fabseq/machine/torch_samples.h"

#include "fabseq/machine/torch.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

double dot(const Point<3>& a, const Point<3>& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Point<3> unit(double x, double y, double z) {
  const double length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}

TEST(TorchSamplesTest, FillTheTorchBelowAHeight) {
  ToolSettings settings;
  settings.profile = {{0.5, 0.2}, {1.0, 1.0}, {6.0, 2.0}};
  settings.clearance = 0.1;
  const Torch torch(settings);
  double widest = 0.0, highest = 0.0, lowest = 1e9;
  for (const Point<3>& point : torch_samples<3>(settings, {0.0, 1.0, 0.0}, 4.0, 500)) {
    const double distance = std::hypot(point[0], point[2]);
    EXPECT_LE(distance, torch.radius(point[1]) + 1e-12);
    widest = std::max(widest, distance / torch.radius(point[1]));
    highest = std::max(highest, point[1]);
    lowest = std::min(lowest, point[1]);
  }
  EXPECT_GT(widest, 0.99);
  EXPECT_LE(highest, 4.0);
  EXPECT_GT(highest, 3.97);
  EXPECT_LT(lowest, 0.51);
  for (const Point<2>& point : torch_samples<2>(settings, {0.0, 1.0}, 9.0, 100))
    EXPECT_LE(std::abs(point[0]), torch.radius(point[1]) + 1e-12);
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
