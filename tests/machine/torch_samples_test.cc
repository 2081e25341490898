// SPDX-License-Identifier: MIT
/// Points that fill a torch (docs/developer/numerics.md 13.2).
#include "fabseq/machine/torch.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fabseq {
namespace {

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

}  // namespace
}  // namespace fabseq
