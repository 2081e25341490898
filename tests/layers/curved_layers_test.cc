// SPDX-License-Identifier: MIT
/// Stage and layer densities: what must hold exactly, and their derivative (formulation 3.1).
#include "fabseq/layers/curved_layers.h"

#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fabseq {
namespace {

constexpr int elements = 101;
constexpr int count = 7;

std::vector<double> grey_density() {
  std::vector<double> result;
  for (int e = 0; e < elements; ++e) result.push_back(0.05 + 0.95 * test::noise(e));
  return result;
}
/// 0, 0.01, ... 1.
std::vector<double> even_times() {
  std::vector<double> result;
  for (int e = 0; e < elements; ++e) result.push_back(e / (elements - 1.0));
  return result;
}
/// Formulation 3.1, as printed.
double step_down(double time, double point, double beta) {
  return 1.0 - (std::tanh(beta * point) + std::tanh(beta * (time - point))) /
                   (std::tanh(beta * point) + std::tanh(beta * (1.0 - point)));
}

LayerDensities densities_of(const CurvedLayers& layers, const std::vector<double>& time) {
  LayerDensities result;
  layers.set_densities(time, result);
  return result;
}

/// The part's density does not matter.
std::vector<double> layer_index(const std::vector<double>& time, const std::vector<double>& time_points) {
  return CurvedLayers({}, time_points, 10.0, false).layer_index(time, {});
}

TEST(CurvedLayers, FollowTheFormula) {
  const auto density = grey_density();
  const auto time = even_times();
  const LayerDensities layers =
      densities_of(CurvedLayers(density, uniform_time_points(count), 23.0, false), time);
  ASSERT_EQ(layers.count(), count);
  ASSERT_EQ(layers.time_points.size(), count + 1u);
  for (int j = 0; j <= count; ++j) EXPECT_NEAR(layers.time_points[j], j / 7.0, 1e-16);
  for (int j = 0; j < count - 1; ++j)
    for (int e = 0; e < elements; ++e)
      EXPECT_NEAR(layers.stage[j][e], density[e] * step_down(time[e], (j + 1) / 7.0, 23.0), 1e-15);
}

TEST(CurvedLayers, SumUpToThePart) {
  const auto density = grey_density();
  for (const double beta : {0.5, 10.0, 300.0})
    for (const bool binary : {false, true}) {
      const LayerDensities layers =
          densities_of(CurvedLayers(density, uniform_time_points(count), beta, binary), even_times());
      for (int e = 0; e < elements; ++e) {
        double total = 0.0;
        for (int j = 0; j < count; ++j) {
          total += layers.layer[j][e];
          EXPECT_NEAR(layers.stage[j][e], total, 1e-15);
        }
        EXPECT_NEAR(total, density[e], 1e-15);
        EXPECT_EQ(layers.stage[count - 1][e], density[e]);
      }
    }
}

TEST(CurvedLayers, GrowFromStageToStageAndAreOlderNearThePlate) {
  const std::vector<double> density(elements, 1.0);
  const LayerDensities layers =
      densities_of(CurvedLayers(density, uniform_time_points(count), 40.0, false), even_times());
  for (int j = 0; j < count; ++j)
    for (int e = 0; e < elements; ++e) {
      EXPECT_GE(layers.layer[j][e], -1e-15);
      EXPECT_LE(layers.stage[j][e], 1.0 + 1e-15);
      EXPECT_LE(layers.stage[j][e], layers.stage[j][std::max(e - 1, 0)]);
    }
  // The whole step, whatever the sharpness: everything at t = 0, nothing at t = 1.
  for (int j = 0; j < count - 1; ++j) {
    EXPECT_NEAR(layers.stage[j].front(), 1.0, 1e-15);
    EXPECT_NEAR(layers.stage[j].back(), 0.0, 1e-15);
  }
}

/// Guided times are neither clamped nor normalized.
TEST(CurvedLayers, HoldWhatIsBeyondTheEndsInTheFirstAndInTheLast) {
  const std::vector<double> time = {-2.0, -0.1, -1e-9, 1.0 + 1e-9, 1.05, 1.3, 40.0};
  const std::vector<double> density = {1.0, 0.5, 1.0, 1.0, 0.5, 1.0, 1.0};
  for (const double beta : {0.5, 10.0, 300.0})
    for (const bool binary : {false, true}) {
      const LayerDensities layers =
          densities_of(CurvedLayers(density, uniform_time_points(count), beta, binary), time);
      for (std::size_t e = 0; e < time.size(); ++e)
        for (int j = 0; j < count; ++j) {
          EXPECT_NEAR(layers.layer[j][e], j == (e < 3 ? 0 : count - 1) ? density[e] : 0.0, 1e-15) << time[e];
          EXPECT_NEAR(layers.stage[j][e], e < 3 || j == count - 1 ? density[e] : 0.0, 1e-15) << time[e];
        }
      std::vector<double> d_time(time.size(), 0.0);
      DensityDerivatives derivatives(count);
      derivatives.stage[2].assign(time.size(), 1.0);
      derivatives.layer[count - 1].assign(time.size(), 1.0);
      CurvedLayers(density, uniform_time_points(count), beta, binary)
          .pull_back(time, {}, derivatives, d_time, {});
      EXPECT_EQ(test::largest(d_time), 0.0);
    }
}

TEST(CurvedLayers, BinaryElementsOnATimePointBelongToTheEarlierLayer) {
  const std::vector<double> time = {0.0, 0.25, 0.25 + 0.9e-12, 0.25 + 1.1e-12, 0.5 - 1e-9, 0.75, 1.0};
  const std::vector<double> expected = {1, 1, 1, 2, 2, 3, 4};
  const std::vector<double> density(time.size(), 0.5);
  const LayerDensities layers = densities_of(CurvedLayers(density, uniform_time_points(4), 10.0, true), time);
  for (std::size_t e = 0; e < time.size(); ++e)
    for (int j = 0; j < 4; ++j) {
      EXPECT_EQ(layers.layer[j][e], j + 1 == expected[e] ? 0.5 : 0.0) << e << ' ' << j;
      EXPECT_EQ(layers.stage[j][e], j + 1 >= expected[e] ? 0.5 : 0.0) << e << ' ' << j;
    }
  EXPECT_EQ(layer_index(time, uniform_time_points(4)), expected);
}

TEST(CurvedLayers, LayerIndexStaysInRange) {
  const std::vector<double> time = {-1e-3, 0.0, 1.0, 1.0 + 1e-3};
  EXPECT_EQ(layer_index(time, uniform_time_points(3)), (std::vector<double>{1, 1, 3, 3}));
}

TEST(CurvedLayers, SmoothLayersBecomeBinaryOnes) {
  const std::vector<double> density(elements, 1.0);
  std::vector<double> time = even_times();
  for (double& t : time) t = 0.99 * t + 0.0031;  // off the time points
  const LayerDensities smooth =
      densities_of(CurvedLayers(density, uniform_time_points(count), 1e5, false), time);
  const LayerDensities binary =
      densities_of(CurvedLayers(density, uniform_time_points(count), 1e5, true), time);
  for (int j = 0; j < count; ++j)
    EXPECT_LT(test::relative_difference(smooth.layer[j], binary.layer[j]), 1e-12);
}

/// A linear functional of all densities, with random weights.
struct Functional {
  DensityDerivatives weights{count};

  Functional() {
    for (int j = 0; j < count; ++j)
      for (int e = 0; e < elements; ++e) {
        DensityDerivatives::zeros_if_empty(weights.stage[j], elements)[e] = test::noise(e, 2 * j) - 0.5;
        DensityDerivatives::zeros_if_empty(weights.layer[j], elements)[e] = test::noise(e, 2 * j + 1) - 0.5;
      }
    weights.stage[2].clear();  // layers nobody touched
    weights.layer[4].clear();
  }
  /// The terms of one element.
  double operator()(const LayerDensities& layers, int e) const {
    double total = 0.0;
    for (int j = 0; j < count; ++j) {
      if (!weights.stage[j].empty()) total += weights.stage[j][e] * layers.stage[j][e];
      if (!weights.layer[j].empty()) total += weights.layer[j][e] * layers.layer[j][e];
    }
    return total;
  }
};

TEST(CurvedLayers, DerivativeAgreesWithDifferences) {
  const auto density = grey_density();
  const auto time = even_times();
  const Functional functional;
  for (const double beta : {10.0, 60.0}) {
    const CurvedLayers layers(density, uniform_time_points(count), beta, false);
    std::vector<double> derivative(elements, 3.0);  // added to what is there
    layers.pull_back(time, {}, functional.weights, derivative, {});
    const std::vector<double> ones(elements, 1.0);
    for (int e = 1; e + 1 < elements; ++e) {  // at both ends the step has a kink
      const auto value = [&](double step) {
        return functional(densities_of(layers, test::moved(time, step, ones)), e);
      };
      EXPECT_NEAR(derivative[e], 3.0 + test::central_difference(value, 1e-4), 1e-6 * beta);
    }
  }
}

/// Uneven, and the third and fourth out of order.
std::vector<double> uneven_time_points() { return {0.0, 0.08, 0.31, 0.52, 0.47, 0.7, 0.93, 1.0}; }

TEST(CurvedLayers, TimePointDerivativeAgreesWithDifferences) {
  const auto density = grey_density();
  const auto time = even_times();
  const Functional functional;
  for (const double beta : {10.0, 60.0}) {
    std::vector<double> d_time(elements, 0.0), derivative(count - 1, 3.0);  // added to what is there
    CurvedLayers(density, uneven_time_points(), beta, false)
        .pull_back(time, {}, functional.weights, d_time, derivative);
    for (int j = 1; j < count; ++j) {
      const auto value = [&](double step) {
        std::vector<double> points = uneven_time_points();
        points[j] += step;
        const LayerDensities layers = densities_of(CurvedLayers(density, points, beta, false), time);
        double total = 0.0;
        for (int e = 0; e < elements; ++e) total += functional(layers, e);
        return total;
      };
      EXPECT_NEAR(derivative[j - 1], 3.0 + test::central_difference(value, 1e-3), 1e-6 * beta);
    }
  }
}

TEST(CurvedLayers, LayerIndexFollowsVariableTimePoints) {
  const std::vector<double> time = {0.0, 0.08, 0.09, 0.4, 0.5, 0.6, 0.71, 1.0};
  EXPECT_EQ(layer_index(time, uneven_time_points()), (std::vector<double>{1, 1, 2, 3, 3, 5, 6, 7}));
}

TEST(CurvedLayers, LastStageDoesNotDependOnTime) {
  const auto density = grey_density();
  DensityDerivatives derivatives(count);
  derivatives.stage[count - 1].assign(elements, 1.0);
  std::vector<double> d_time(elements, 0.0);
  CurvedLayers(density, uniform_time_points(count), 10.0, false)
      .pull_back(even_times(), {}, derivatives, d_time, {});
  EXPECT_EQ(test::largest(d_time), 0.0);
}

TEST(CurvedLayers, BinaryLayersHaveNoDerivative) {
  const auto density = grey_density();
  std::vector<double> d_time(elements, 0.0);
  CurvedLayers(density, uniform_time_points(count), 10.0, true)
      .pull_back(even_times(), {}, Functional().weights, d_time, {});
  EXPECT_EQ(test::largest(d_time), 0.0);
}

TEST(CurvedLayers, OneLayerIsThePart) {
  const auto density = grey_density();
  const LayerDensities layers =
      densities_of(CurvedLayers(density, uniform_time_points(1), 10.0, false), even_times());
  EXPECT_EQ(layers.stage[0], density);
  EXPECT_EQ(layers.layer[0], density);
}

}  // namespace
}  // namespace fabseq
