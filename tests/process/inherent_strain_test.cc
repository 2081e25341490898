// SPDX-License-Identifier: MIT
/// Strain that turns with the layers (formulation 4.2, 4.5).
#include "fabseq/process/inherent_strain.h"

#include "support/brute_force.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <int Dim>
MaterialSettings turning(double tangential, double normal, std::vector<double> scale) {
  MaterialSettings material;
  material.turning_strain = TurningStrain{tangential, normal};
  material.strain_scale = std::move(scale);
  return material;
}

template <int Dim>
std::vector<double> scale() {
  return Dim == 2 ? std::vector<double>{1.3, 0.6} : std::vector<double>{1.3, 0.6, 0.9};
}

/// The strains of elements 0 to `elements` - 1 in steps 0 to `steps` - 1, [element][step][Voigt].
template <int Dim>
std::vector<double> strains_of(const StrainSource<Dim>& source, int elements, int steps = 1) {
  std::vector<double> result(static_cast<std::size_t>(elements * steps * voigt_size<Dim>));
  auto next = result.begin();
  for (int e = 0; e < elements; ++e)
    for (int j = 0; j < steps; ++j, next += voigt_size<Dim>)
      source.set_strains({&e, 1}, {j, 1}, {next, next + voigt_size<Dim>});
  return result;
}
/// Those of directions across the layers, [element][axis].
template <int Dim>
std::vector<double> strains_across(InherentStrain<Dim> strain, const std::vector<double>& gradient) {
  strain.set(gradient, {}, {});
  return strains_of(strain, static_cast<int>(gradient.size()) / Dim);
}

template <class T>
class InherentStrainTest : public testing::Test {};
TYPED_TEST_SUITE(InherentStrainTest, test::Dimensions);

/// t^T eps t is the tangential strain for every direction t within the layer, n^T eps n the normal one.
TYPED_TEST(InherentStrainTest, IsTangentialWithinTheLayerAndNormalAcross) {
  constexpr int Dim = TypeParam::value;
  const InherentStrain<Dim> strain(turning<Dim>(-0.01, 0.004, std::vector<double>(Dim, 1.0)), 1.0);
  std::vector<double> gradient;
  for (int i = 0; i < 5 * Dim; ++i) gradient.push_back(3.0 * test::noise(i) - 1.0);
  const auto strains = strains_across(strain, gradient);
  for (std::size_t e = 0; e < 5; ++e) {
    const auto first = strains.begin() + static_cast<std::ptrdiff_t>(e * voigt_size<Dim>);
    const auto tensor = test::strain_tensor<Dim>(std::vector<double>(first, first + voigt_size<Dim>));
    double length = 0.0;
    for (int a = 0; a < Dim; ++a) length += std::pow(gradient[e * Dim + a], 2);
    for (int a = 0; a < Dim; ++a) {
      double image = 0.0;  // eps n
      for (int b = 0; b < Dim; ++b) image += tensor[a][b] * gradient[e * Dim + b] / std::sqrt(length);
      EXPECT_NEAR(image, 0.004 * gradient[e * Dim + a] / std::sqrt(length), 1e-9);
    }
    double trace = 0.0;
    for (int a = 0; a < Dim; ++a) trace += tensor[a][a];
    EXPECT_NEAR(trace, 0.004 - 0.01 * (Dim - 1), 1e-9);
  }
}

TYPED_TEST(InherentStrainTest, IsScaledAxisByAxis) {
  constexpr int Dim = TypeParam::value;
  const auto s = scale<Dim>();
  const std::vector<double> gradient =
      Dim == 2 ? std::vector<double>{0.4, -0.8} : std::vector<double>{0.4, -0.8, 0.3};
  const InherentStrain<Dim> unscaled(turning<Dim>(-0.01, 0.004, std::vector<double>(Dim, 1.0)), 1.0);
  const auto plain = strains_across(unscaled, gradient);
  const auto scaled = strains_across(InherentStrain<Dim>(turning<Dim>(-0.01, 0.004, s), 1.0), gradient);
  for (int a = 0; a < Dim; ++a) EXPECT_NEAR(scaled[a], s[a] * plain[a], 1e-16);
  EXPECT_NEAR(scaled[Dim], std::sqrt(s[0] * s[1]) * plain[Dim], 1e-16);
  if (Dim == 3) {
    EXPECT_NEAR(scaled[Dim + 1], std::sqrt(s[1] * s[Dim - 1]) * plain[Dim + 1], 1e-16);
    EXPECT_NEAR(scaled[Dim + 2], std::sqrt(s[0] * s[Dim - 1]) * plain[Dim + 2], 1e-16);
  }
}

TYPED_TEST(InherentStrainTest, IsTangentialAllAroundWithoutAGradient) {
  constexpr int Dim = TypeParam::value;
  const InherentStrain<Dim> strain(turning<Dim>(-0.01, 0.004, std::vector<double>(Dim, 1.0)), 2.0);
  const auto strains = strains_across(strain, std::vector<double>(Dim, 0.0));
  for (int c = 0; c < voigt_size<Dim>; ++c) EXPECT_EQ(strains[c], c < Dim ? -0.01 : 0.0);
}

/// Layers of sub-parts take the print direction, whatever the pseudo-time does.
TYPED_TEST(InherentStrainTest, TurnsWithTheSubParts) {
  constexpr int Dim = TypeParam::value;
  InherentStrain<Dim> strain(turning<Dim>(-0.01, 0.004, scale<Dim>()), 1.0);
  LayerDensities layers;
  SubParts& sub_parts = layers.sub_parts;
  sub_parts.density.resize(2);
  sub_parts.directions = Dim == 2 ? std::vector<double>{0.6, 0.8, 0.0, 1.0}
                                  : std::vector<double>{0.6, 0.0, 0.8, 0.36, 0.48, 0.8};
  sub_parts.of_layer = {0, 0, 1};
  strain.set({}, layers, {});
  EXPECT_EQ(strain.variation(), StrainVariation::by_step);
  ASSERT_EQ(strain.input_count(), 3u * voigt_size<Dim>);
  const auto strains = strains_of(strain, 1, 3);
  for (int j = 0; j < 3; ++j) {
    const auto first = sub_parts.directions.begin() + sub_parts.of_layer[j] * Dim;
    const auto expected = strains_across(strain, std::vector<double>(first, first + Dim));
    for (int c = 0; c < voigt_size<Dim>; ++c)
      EXPECT_NEAR(strains[j * voigt_size<Dim> + c], expected[c], 1e-10);
  }
  std::vector<double> weights;
  for (int i = 0; i < 3 * voigt_size<Dim>; ++i) weights.push_back(test::noise(i, 2) - 0.5);
  std::vector<double> d_gradient;
  DensityDerivatives derivatives(3);
  strain.pull_back({}, layers, weights, d_gradient, derivatives);
  EXPECT_TRUE(d_gradient.empty());
  const std::vector<double> start = sub_parts.directions;
  std::vector<double> direction;
  for (int i = 0; i < 2 * Dim; ++i) direction.push_back(test::noise(i, 1) - 0.5);
  const double expected = test::central_difference(
      [&](double step) {
        sub_parts.directions = test::moved(start, step, direction);
        double total = 0.0;
        strain.set({}, layers, {});
        const auto moved = strains_of(strain, 1, 3);
        for (std::size_t i = 0; i < weights.size(); ++i) total += weights[i] * moved[i];
        return total;
      },
      1e-3);
  double product = 0.0;
  for (std::size_t i = 0; i < direction.size(); ++i) product += derivatives.directions[i] * direction[i];
  EXPECT_NEAR(product, expected, 1e-7 * std::abs(expected));
}

TYPED_TEST(InherentStrainTest, OthersDoNotTurn) {
  constexpr int Dim = TypeParam::value;
  MaterialSettings material;
  material.inherent_strain = test::some_strain<Dim>();
  InherentStrain<Dim> strain(material, 1.0);
  strain.set(std::vector<double>(Dim, 1.0), {}, {});
  EXPECT_FALSE(strain.turns());
  EXPECT_EQ(strain.variation(), StrainVariation::none);
  EXPECT_EQ(strain.input_count(), 0u);
  EXPECT_EQ(strains_of(strain, 1), test::some_strain<Dim>());
}

TYPED_TEST(InherentStrainTest, DerivativeAgreesWithDifferences) {
  constexpr int Dim = TypeParam::value;
  // A length so small that the regularization counts.
  const InherentStrain<Dim> strain(turning<Dim>(-0.01, 0.004, scale<Dim>()), 1e-4);
  std::vector<double> gradient, direction, weights;
  for (int i = 0; i < 4 * Dim; ++i) {
    gradient.push_back(test::noise(i) - 0.4);
    direction.push_back(test::noise(i, 1) - 0.5);
  }
  for (int i = 0; i < 4 * voigt_size<Dim>; ++i) weights.push_back(test::noise(i, 2) - 0.5);
  const auto value = [&](double step) {
    const auto strains = strains_across(strain, test::moved(gradient, step, direction));
    double total = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) total += weights[i] * strains[i];
    return total;
  };
  std::vector<double> derivative(gradient.size(), 0.0);
  DensityDerivatives of_densities(0);
  strain.pull_back(gradient, {}, weights, derivative, of_densities);
  double product = 0.0;
  for (std::size_t i = 0; i < direction.size(); ++i) product += derivative[i] * direction[i];
  const double expected = test::central_difference(value, 1e-3);
  EXPECT_NEAR(product, expected, 1e-7 * std::abs(expected));
}

/// Three layers with shares: of the material's strain, and of one that turns with the elements.
TYPED_TEST(InherentStrainTest, LayersGetTheirShares) {
  constexpr int Dim = TypeParam::value;
  constexpr int elements = 2, steps = 3;
  MaterialSettings material;
  material.inherent_strain = test::some_strain<Dim>();
  const std::vector<double> share = {1.0, 0.4, 0.7};
  std::vector<double> gradient, direction, weights;
  for (int i = 0; i < elements * Dim; ++i) gradient.push_back(test::noise(i) + 0.2);
  for (int i = 0; i < steps; ++i) direction.push_back(test::noise(i, 1) - 0.5);
  for (int i = 0; i < elements * steps * voigt_size<Dim>; ++i) weights.push_back(test::noise(i, 2) - 0.5);
  for (InherentStrain<Dim> strain : {InherentStrain<Dim>(material, 1.0),
                                     InherentStrain<Dim>(turning<Dim>(-0.01, 0.004, scale<Dim>()), 1.0)}) {
    const auto value = [&](double step) {
      strain.set(gradient, {}, test::moved(share, step, direction));
      const auto strains = strains_of(strain, elements, steps);
      double total = 0.0;
      for (std::size_t i = 0; i < weights.size(); ++i) total += weights[i] * strains[i];
      return total;
    };
    const double expected = test::central_difference(value, 1e-3);
    strain.set(gradient, {}, {});
    const auto full = strains_of(strain, elements, steps);
    strain.set(gradient, {}, share);
    const auto strains = strains_of(strain, elements, steps);
    EXPECT_EQ(strain.variation(), strain.turns() ? StrainVariation::by_element : StrainVariation::by_step);
    for (std::size_t i = 0; i < strains.size(); ++i)
      EXPECT_EQ(strains[i], full[i] * share[i / voigt_size<Dim> % steps]);
    std::vector<double> d_inputs(strain.input_count(), 0.0);
    for (int e = 0; e < elements; ++e)
      for (int j = 0; j < steps; ++j)
        strain.add_derivatives(
            {&e, 1}, {j, 1},
            std::span<const double>(weights).subspan((e * steps + j) * voigt_size<Dim>, voigt_size<Dim>),
            d_inputs);
    double product = 0.0;
    for (int j = 0; j < steps; ++j) product += strain.of_shares(d_inputs)[j] * direction[j];
    EXPECT_NEAR(product, expected, 1e-9 * std::abs(expected));
  }
}

}  // namespace
}  // namespace fabseq
