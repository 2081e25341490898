// SPDX-License-Identifier: MIT
/// Build directions as tilt vectors (docs/formulation.md 2.4).
#include "sequence/tilt_vectors.h"

#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace fabseq {
namespace {

constexpr double right_angle = 0.5 * std::numbers::pi;

TEST(TiltVectorsTest, LeanAlongTheOtherAxesInTheirOrder) {
  const TiltVectors<3> from_top({1, true});
  const Point<3> upright = from_top.direction(std::vector<double>{0.0, 0.0}.data());
  EXPECT_EQ(upright, (Point<3>{0.0, -1.0, 0.0}));
  const Point<3> level = from_top.direction(std::vector<double>{0.0, right_angle}.data());
  EXPECT_NEAR(level[2], 1.0, 1e-15);
  EXPECT_NEAR(level[1], 0.0, 1e-15);
  const Point<2> plane = TiltVectors<2>({0, false}).direction(std::vector<double>{-0.3}.data());
  EXPECT_NEAR(plane[0], std::cos(0.3), 1e-15);
  EXPECT_NEAR(plane[1], -std::sin(0.3), 1e-15);
}

template <class T>
class TiltVectorsOfTest : public testing::Test {};
TYPED_TEST_SUITE(TiltVectorsOfTest, test::Dimensions);

template <int Dim>
std::vector<std::vector<double>> some_tilts() {
  // On both sides of where series take the place of quotients.
  std::vector<std::vector<double>> result;
  for (const double length : {0.0, 1e-8, 0.9e-3, 1.1e-3, 0.4, 1.5, 2.8}) {
    std::vector<double> tilt = {0.8 * length};
    if (Dim == 3) tilt.push_back(-0.6 * length);
    result.push_back(tilt);
  }
  return result;
}

TYPED_TEST(TiltVectorsOfTest, ComeBackFromTheirDirections) {
  constexpr int Dim = TypeParam::value;
  for (const BuildPlate plate : {BuildPlate{Dim - 1, false}, BuildPlate{0, true}}) {
    const TiltVectors<Dim> tilts(plate);
    for (const std::vector<double>& tilt : some_tilts<Dim>()) {
      Point<Dim> direction = tilts.direction(tilt.data());
      EXPECT_NEAR(dot(direction, direction), 1.0, 1e-14);
      EXPECT_NEAR(dot(direction, plate.normal<Dim>()), std::cos(std::sqrt(test::dot(tilt, tilt))), 1e-14);
      for (double& component : direction) component *= 3.0;
      const auto back = tilts.tilt_of(direction);
      for (int i = 0; i < Dim - 1; ++i) EXPECT_NEAR(back[i], tilt[i], 1e-14);
    }
  }
}

TYPED_TEST(TiltVectorsOfTest, DerivativesAgreeWithDifferences) {
  constexpr int Dim = TypeParam::value;
  const TiltVectors<Dim> tilts({0, true});
  Point<Dim> weights;
  for (int axis = 0; axis < Dim; ++axis) weights[axis] = 0.7 - 1.1 * axis;
  for (const std::vector<double>& tilt : some_tilts<Dim>()) {
    std::vector<double> gradient(Dim - 1, 0.25);  // it is added to
    tilts.add_derivative(tilt.data(), weights, gradient.data());
    for (int i = 0; i < Dim - 1; ++i) {
      const double expected = test::central_difference(
          [&](double step) {
            std::vector<double> there = tilt;
            there[i] += step;
            return dot(weights, tilts.direction(there.data()));
          },
          1e-2);
      EXPECT_NEAR(gradient[i], 0.25 + expected, 1e-8) << tilt[0];
    }
  }
}

}  // namespace
}  // namespace fabseq
