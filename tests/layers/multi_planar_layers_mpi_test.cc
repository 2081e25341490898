// SPDX-License-Identifier: MIT
/// Layers of sub-parts against the formulas as printed, their derivatives against differences
/// (formulation 3.2).
#include "layers/multi_planar_layers.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

double logistic(double x) { return 1.0 / (1.0 + std::exp(-x)); }

template <int Dim>
struct Case {
  Case() {
    settings.subparts = 3;
    settings.timestamps = {0.3, 0.62};
    settings.thickness = 0.55;
    settings.time_sharpness = 25.0;
    settings.slab_sharpness = 8.0;
    // Down to the left, too: slabs of negative numbers.
    settings.angles =
        Dim == 2 ? std::vector<double>{0.4, 2.1, 1.2} : std::vector<double>{0.9, 0.3, 0.5, 2.0, -0.4, 1.0};
    time = test::noise_field(part(), 0.0, 1.0);
  }

  const Part<Dim>& part() const { return on_grid.part; }
  MultiPlanarLayers<Dim> layers(const std::vector<double>& angles, bool binary = false,
                                NegligibleLayers negligible = {}) const {
    return {part(), settings, angles, binary, negligible};
  }
  MultiPlanarLayers<Dim> layers() const { return layers(settings.angles); }
  LayerDensities densities(const MultiPlanarLayers<Dim>& of) const {
    LayerDensities result;
    of.set_densities(time, result);
    return result;
  }
  std::vector<double> direction(int i) const {
    const double* angle = &settings.angles[static_cast<std::size_t>(i) * (Dim - 1)];
    if (Dim == 2) return {std::cos(angle[0]), std::sin(angle[0])};
    return {std::cos(angle[0]) * std::cos(angle[1]), std::cos(angle[0]) * std::sin(angle[1]),
            std::sin(angle[0])};
  }
  /// S_i of part element e.
  double height(int i, std::size_t e) const {
    const auto center =
        part().grid().element_center(part().grid().owned_elements().index(part().elements()[e]));
    double result = 0.0;
    for (int a = 0; a < Dim; ++a)
      result += (center[a] - (settings.origin.empty() ? 0.0 : settings.origin[a])) * direction(i)[a];
    return result;
  }
  double built_until(int i, double t) const {
    if (i == 0) return 0.0;
    return i == 3 ? 1.0 : 1.0 - logistic(settings.time_sharpness * (t - settings.timestamps[i - 1]));
  }
  double slab(int i, int j, std::size_t e) const {
    const double w = settings.thickness;
    return logistic(settings.slab_sharpness *
                    (1.0 - 4.0 / (w * w) * std::pow(height(i, e) - (j - 0.5) * w, 2)));
  }

  test::PartOnGrid<Dim> on_grid{test::odd_domain<Dim>(), test::gallows<Dim>()};
  MultiPlanarSettings settings;
  std::vector<double> time;
};

template <class T>
class MultiPlanarLayersTest : public testing::Test {};
TYPED_TEST_SUITE(MultiPlanarLayersTest, test::Dimensions);

template <int Dim>
void expect_formulas(const Case<Dim>& c) {
  const LayerDensities densities = c.densities(c.layers());
  EXPECT_TRUE(densities.time_points.empty());
  const SubParts& sub_parts = densities.sub_parts;
  ASSERT_EQ(sub_parts.count(), 3);
  int layer = 0;
  for (int i = 0; i < 3; ++i) {
    double lowest = 1e9, highest = -1e9;
    for (std::size_t e = 0; e < c.time.size(); ++e) {
      lowest = std::min(lowest, c.height(i, e));
      highest = std::max(highest, c.height(i, e));
    }
    const double w = c.settings.thickness;
    const int first = static_cast<int>(std::floor(min(PETSC_COMM_WORLD, lowest) / w));
    const int last = static_cast<int>(std::ceil(max(PETSC_COMM_WORLD, highest) / w)) + 1;
    std::vector<double> built(c.time.size(), 0.0);
    for (int j = first; j <= last; ++j, ++layer) {
      ASSERT_EQ(sub_parts.of_layer[layer], i);
      ASSERT_EQ(sub_parts.slab[layer], j);
      for (std::size_t e = 0; e < c.time.size(); ++e) {
        const double before = c.built_until(i, c.time[e]), own = c.built_until(i + 1, c.time[e]) - before;
        built[e] += c.slab(i, j, e);
        EXPECT_NEAR(densities.layer[layer][e], own * c.slab(i, j, e), 1e-14);
        EXPECT_NEAR(densities.stage[layer][e], before + own * built[e], 1e-13);
        EXPECT_NEAR(sub_parts.density[i][e], own, 1e-14);
      }
    }
  }
  EXPECT_EQ(layer, densities.count());
}

TYPED_TEST(MultiPlanarLayersTest, FollowTheFormulas) {
  Case<TypeParam::value> c;
  expect_formulas(c);
  c.settings.origin = std::vector<double>{-0.3, 0.7, 0.15};
  c.settings.origin.resize(TypeParam::value);
  expect_formulas(c);
}

/// Between their middles two sharp slabs hold all there is; in the end the part stands.
TYPED_TEST(MultiPlanarLayersTest, SharpOnesSumUpToThePart) {
  for (const bool binary : {false, true}) {
    Case<TypeParam::value> c;
    c.settings.slab_sharpness = 400.0;
    const LayerDensities densities = c.densities(c.layers(c.settings.angles, binary));
    std::vector<double> total(c.time.size(), 0.0);
    for (const auto& layer : densities.layer)
      for (std::size_t e = 0; e < layer.size(); ++e) total[e] += layer[e];
    for (std::size_t e = 0; e < total.size(); ++e) {
      EXPECT_NEAR(total[e], 1.0, binary ? 0.0 : 2e-3);
      EXPECT_NEAR(densities.stage.back()[e], 1.0, binary ? 0.0 : 2e-3);
    }
  }
}

TYPED_TEST(MultiPlanarLayersTest, BinaryOnesAreThoseOfTheLayerIndex) {
  const Case<TypeParam::value> c;
  const auto layers = c.layers(c.settings.angles, true);
  const LayerDensities densities = c.densities(layers);
  const std::vector<double> index = layers.layer_index(c.time, densities);
  for (std::size_t e = 0; e < index.size(); ++e) {
    const auto layer = static_cast<std::size_t>(index[e]) - 1;
    const int i = densities.sub_parts.of_layer[layer];
    EXPECT_EQ(i, c.time[e] <= 0.3 ? 0 : c.time[e] <= 0.62 ? 1 : 2);
    EXPECT_EQ(densities.sub_parts.slab[layer],
              static_cast<int>(std::ceil(c.height(i, e) / c.settings.thickness)));
    for (std::size_t j = 0; j < densities.layer.size(); ++j)
      EXPECT_EQ(densities.layer[j][e], j == layer ? 1.0 : 0.0);
  }
}

/// The layers that are left are the same; those that are gone had less than what is negligible.
TYPED_TEST(MultiPlanarLayersTest, LeaveOutWhatIsNegligible) {
  Case<TypeParam::value> c;
  c.settings.time_sharpness = 200.0;
  for (std::size_t e = 0; e < c.time.size(); ++e)  // sub-parts apart from each other
    c.time[e] = 0.5 + 0.12 * (c.height(0, e) + c.time[e]);
  const LayerDensities all = c.densities(c.layers());
  const NegligibleLayers negligible{1e-15, 3.0};
  const LayerDensities some = c.densities(c.layers(c.settings.angles, false, negligible));
  EXPECT_LT(some.count(), all.count());
  EXPECT_NEAR(negligible.density(all.count()), std::cbrt(1e-15 / all.count()), 1e-12);
  int next = 0;
  for (int j = 0; j < all.count(); ++j) {
    const double largest = max(PETSC_COMM_WORLD, test::largest(all.layer[j]));
    if (largest <= negligible.density(all.count())) continue;
    ASSERT_LT(next, some.count());
    EXPECT_EQ(some.sub_parts.slab[next], all.sub_parts.slab[j]);
    EXPECT_EQ(some.layer[next], all.layer[j]);
    EXPECT_EQ(some.stage[next], all.stage[j]);
    ++next;
  }
  EXPECT_EQ(next, some.count());
}

/// A linear functional of all there is, with random weights, of this rank.
template <int Dim>
struct Functional {
  Functional(const Part<Dim>& part, const LayerDensities& densities) : weights(densities.count()) {
    for (int j = 0; j < densities.count(); ++j) {
      weights.stage[j] = test::noise_field(part, -0.5, 0.5, 2 * j);
      weights.layer[j] = test::noise_field(part, -0.5, 0.5, 2 * j + 1);
    }
    weights.stage[1].clear();  // layers nobody touched
    weights.layer[2].clear();
    weights.sub_part_or_zeros(densities.sub_parts, 1) = test::noise_field(part, -0.5, 0.5, 99);
    // What is explicit in the directions, the ranks share.
    auto& directions = weights.directions_or_zeros(densities.sub_parts);
    for (std::size_t d = 0; d < directions.size(); ++d)
      directions[d] = test::noise(static_cast<std::int64_t>(d), 7) / size_of(PETSC_COMM_WORLD);
  }
  double operator()(const LayerDensities& densities) const {
    double total = 0.0;
    const auto add = [&](const std::vector<double>& weight, const std::vector<double>& values) {
      for (std::size_t i = 0; i < weight.size(); ++i) total += weight[i] * values[i];
    };
    for (int j = 0; j < densities.count(); ++j) {
      add(weights.stage[j], densities.stage[j]);
      add(weights.layer[j], densities.layer[j]);
    }
    add(weights.sub_part[1], densities.sub_parts.density[1]);
    add(weights.directions, densities.sub_parts.directions);
    return sum(PETSC_COMM_WORLD, total);
  }
  DensityDerivatives weights;
};

TYPED_TEST(MultiPlanarLayersTest, DerivativesAgreeWithDifferences) {
  constexpr int Dim = TypeParam::value;
  // With all slabs, and where many are no layers.
  for (const NegligibleLayers& negligible : {NegligibleLayers{}, NegligibleLayers{0.2, 2.0}}) {
    Case<Dim> c;
    const auto layers = c.layers(c.settings.angles, false, negligible);
    const LayerDensities densities = c.densities(layers);
    const Functional<Dim> functional(c.part(), densities);
    std::vector<double> d_time(c.time.size(), 0.0), d_angles(c.settings.angles.size(), 0.0);
    layers.pull_back(c.time, densities, functional.weights, d_time, d_angles);
    sum_in_place(PETSC_COMM_WORLD, d_angles);

    const std::vector<double> time = c.time, along = test::noise_field(c.part(), -1.0, 1.0, 50);
    const auto value_at_time = [&](double step) {
      c.time = test::moved(time, step, along);
      return functional(c.densities(layers));
    };
    const double expected = test::central_difference(value_at_time, 1e-4);
    EXPECT_NEAR(test::dot(d_time, along), expected, 1e-7 * std::abs(expected));
    c.time = time;
    for (std::size_t a = 0; a < d_angles.size(); ++a) {
      const auto value_at_angle = [&](double step) {
        std::vector<double> angles = c.settings.angles;
        angles[a] += step;
        const LayerDensities moved = c.densities(c.layers(angles, false, negligible));
        EXPECT_EQ(moved.sub_parts.slab, densities.sub_parts.slab);
        return functional(moved);
      };
      const double difference = test::central_difference(value_at_angle, 1e-4);
      EXPECT_NEAR(d_angles[a], difference, 1e-7 * std::abs(difference) + 1e-8) << a;
    }
  }
}

/// What a slab that comes or goes with the angle holds is next to nothing: the sum of all squares has no
/// jump.
TYPED_TEST(MultiPlanarLayersTest, NothingJumpsWhereSlabsComeAndGo) {
  Case<TypeParam::value> c;
  c.settings.slab_sharpness = 100.0;
  const NegligibleLayers negligible{1e-15, 3.0};
  const auto value_at = [&](double angle, int& count) {
    std::vector<double> angles = c.settings.angles;
    angles[0] = angle;
    const LayerDensities densities = c.densities(c.layers(angles, false, negligible));
    count = densities.count();
    double total = 0.0;
    for (const auto& layer : densities.layer)
      for (const double density : layer) total += std::pow(density, 6);
    return sum(PETSC_COMM_WORLD, total);
  };
  int changes = 0, count = 0;
  value_at(0.0, count);
  for (int step = 1; step <= 100; ++step) {
    const double angle = 0.015 * step;
    int now = 0;
    value_at(angle, now);
    if (now == count) continue;
    // Halve the interval down to where the number changes.
    double low = angle - 0.015, high = angle;
    for (int halving = 0; halving < 40; ++halving) {
      const double middle = 0.5 * (low + high);
      int there = 0;
      value_at(middle, there);
      (there == count ? low : high) = middle;
    }
    int unused = 0;
    EXPECT_NEAR(value_at(low, unused), value_at(high, unused), 1e-9);
    count = now;
    ++changes;
  }
  EXPECT_GT(changes, 2);
}

}  // namespace
}  // namespace fabseq
