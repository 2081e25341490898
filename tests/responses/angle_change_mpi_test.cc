// SPDX-License-Identifier: MIT
/// Change of angle (formulation 5) of perpendicular, parallel and slanted sets, under motions whose angles
/// are known.
#include "support/measure_case.h"
#include "support/refusal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace fabseq {
namespace {

const std::string perpendicular = R"("measure": "angle", "nodes": "top", "to": "tip")";
const std::string parallel = R"("measure": "angle", "nodes": "back", "to": "tip")";
const std::string slanted = R"("measure": "angle", "nodes": "stairs", "to": "top")";
constexpr double radian = 180.0 / std::numbers::pi;

/// The faces of the gallows; `stairs` are the nodes near a slanted plane, `corner` lies on one edge.
template <int Dim>
Settings with_sets() {
  const auto box = [](const std::string& low, const std::string& high) {
    return R"({"box": {"min": )" + low + R"(, "max": )" + high + "}}";
  };
  Settings result = {
      {"node_sets.back", Dim == 2 ? box("[0, 0]", "[0, 1.5]") : box("[0, 0, 0]", "[0, 0.9, 2.5]")},
      {"node_sets.corner", Dim == 2 ? box("[0, 1.5]", "[0, 1.5]") : box("[0, 0, 2.5]", "[0, 0.9, 2.5]")}};
  const std::string plane = Dim == 2 ? R"("point": [0, 0.3], "normal": [0.6, -1])"
                                     : R"("point": [0, 0, 1.2], "normal": [0.6, -0.2, -1])";
  const std::string other = Dim == 2 ? R"("point": [0, 0.7], "normal": [-0.6, 1])"
                                     : R"("point": [0, 0, 1.9], "normal": [-0.6, 0.2, 1])";
  result.emplace_back("node_sets.stairs", R"({"intersection": [{"half_space": {)" + plane +
                                              R"(}}, {"half_space": {)" + other + "}}]}");
  return result;
}

template <class T>
class AngleChangeTest : public testing::Test {
 protected:
  static constexpr int dim = T::value;
  static constexpr int up = dim - 1;
  using Case = test::MeasureCase<dim>;
  /// The edge that top and tip have in common.
  static constexpr double edge_x = dim == 2 ? 3.0 : 2.0, edge_up = dim == 2 ? 1.5 : 2.5;

  /// Turns the tip about that edge.
  static std::vector<double> turned_tip(const Case& measures, double angle) {
    return measures.displacement([angle](int a, const Point<dim>& x) {
      if (std::abs(x[0] - edge_x) > 1e-9) return 0.0;
      return a == 0 ? -angle * (x[up] - edge_up) : 0.0;
    });
  }
};
TYPED_TEST_SUITE(AngleChangeTest, test::Dimensions);

TYPED_TEST(AngleChangeTest, IsTheAngleByWhichOneFaceTurns) {
  typename TestFixture::Case measures(with_sets<TypeParam::value>());
  for (const std::string& keys : {perpendicular, parallel}) {
    const auto response = measures.make(keys);
    for (const double angle : {1e-3, -2e-5}) {
      const double expected = std::pow(radian * std::atan(angle), 2);
      EXPECT_NEAR(measures.value(*response, this->turned_tip(measures, angle)), expected, 1e-9 * expected)
          << keys;
    }
  }
}

/// In 3D, parallel faces tilt in two directions, and neither counts less.
TYPED_TEST(AngleChangeTest, ParallelFacesTiltInAnyDirection) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case measures(with_sets<Dim>());
  const auto response = measures.make(parallel);
  for (const double slope : {0.0, 3e-3}) {
    const auto tilted = measures.displacement([&](int a, const Point<Dim>& x) {
      if (a > 0 || x[0] < 1.0) return 0.0;
      return 1e-3 * x[Dim - 1] + (Dim == 3 ? slope * x[1] : 0.0);
    });
    const double expected = std::pow(radian * std::atan(std::hypot(1e-3, Dim == 3 ? slope : 0.0)), 2);
    EXPECT_NEAR(measures.value(*response, tilted), expected, 1e-9 * expected);
    EXPECT_LT(measures.error_of_derivative(*response, tilted, 1e-6), 1e-8);
  }
}

/// Rotations are linear, so that they change angles by the square of the angle.
TYPED_TEST(AngleChangeTest, RigidMotionsOfAllLeaveIt) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case measures(with_sets<Dim>());
  for (const std::string& keys : {perpendicular, parallel, slanted}) {
    const auto response = measures.make(keys);
    for (int k = 0; k < rigid_motion_count<Dim>; ++k) {
      const double size = k < Dim ? 0.1 : 1e-4;
      const auto motion = measures.displacement(
          [&](int a, const Point<Dim>& x) { return size * rigid_motion<Dim>(k, a, x); });
      EXPECT_LT(measures.value(*response, motion), std::pow(radian * 2e-8, 2)) << keys << k;
    }
    const auto shift = measures.displacement([](int a, const Point<Dim>&) { return 0.3 - 0.2 * a; });
    EXPECT_LT(measures.value(*response, shift), 1e-25) << keys;
  }
}

TYPED_TEST(AngleChangeTest, DerivativesAgreeWithDifferences) {
  typename TestFixture::Case measures(with_sets<TypeParam::value>());
  const auto nothing = measures.rough_displacement(0.0), rough = measures.rough_displacement(0.01);
  for (const std::string& keys : {perpendicular, parallel, slanted}) {
    const auto response = measures.make(keys);
    EXPECT_GT(measures.value(*response, rough), 1e-6) << keys;
    EXPECT_LT(measures.error_of_derivative(*response, rough, 1e-5), 1e-7) << keys;
    EXPECT_LT(measures.value(*response, nothing), 1e-25) << keys;
    for (const double derivative : measures.derivative(*response, nothing).displacement)
      EXPECT_LT(std::abs(derivative), 1e-10) << keys;
  }
}

TYPED_TEST(AngleChangeTest, AfterTheReleaseBothDisplacementsCount) {
  typename TestFixture::Case measures(with_sets<TypeParam::value>());
  const auto on_plate = measures.make(perpendicular),
             released = measures.make(perpendicular + R"(, "after_release": true)");
  const auto displacement = measures.rough_displacement(0.01), release = measures.rough_displacement(0.02, 7);
  const auto both = test::moved(displacement, 1.0, release);
  const double expected = measures.value(*on_plate, both);
  EXPECT_NEAR(measures.value(*released, displacement, release), expected, 1e-12 * expected);
  const auto derivative = measures.derivative(*on_plate, both);
  const auto found = measures.derivative(*released, displacement, release);
  EXPECT_LT(test::relative_difference(found.displacement, derivative.displacement), 1e-12);
  EXPECT_EQ(found.release, found.displacement);
}

TYPED_TEST(AngleChangeTest, NodesWithoutAPlaneAreRefused) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case measures(with_sets<Dim>());
  const std::string message =
      Dim == 2
          ? "/node_sets/corner: its 1 nodes determine no line for measure angle; allowed: nodes of an edge"
          : "/node_sets/corner: its 4 nodes determine no plane for measure angle; allowed: nodes of a face";
  for (const char* keys : {R"("measure": "angle", "nodes": "corner", "to": "tip")",
                           R"("measure": "angle", "nodes": "tip", "to": "corner")"})
    EXPECT_EQ(test::refusal([&] { (void)measures.make(keys); }), message);
}

}  // namespace
}  // namespace fabseq
