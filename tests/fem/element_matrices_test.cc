// SPDX-License-Identifier: MIT
/// Element matrices against brute-force integration with tensor formulas, and against what is known of them
/// exactly.
#include "fabseq/fem/element_matrices.h"

#include "support/brute_force.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

constexpr double poisson = 0.3;

template <int Dim>
struct Pair {
  static Point<Dim> edges() {
    if constexpr (Dim == 2)
      return {0.7, 1.9};
    else
      return {0.7, 1.9, 0.4};
  }
  double thickness = Dim == 2 ? 0.35 : 1.0;
  ElementMatrices<Dim> element{edges(), thickness, poisson};
  test::BruteForceElement<Dim> expected{edges(), thickness, poisson};
};

/// Displacements of the corners for a field of the position.
template <int Dim, class Field>
std::array<double, element_unknowns<Dim>> corner_values(Field&& field) {
  std::array<double, element_unknowns<Dim>> result{};
  for (int corner = 0; corner < corner_count<Dim>; ++corner) {
    Point<Dim> x{};
    for (int a = 0; a < Dim; ++a) x[a] = ((corner >> a) & 1) * Pair<Dim>::edges()[a];
    const Point<Dim> u = field(x);
    for (int a = 0; a < Dim; ++a) result[corner * Dim + a] = u[a];
  }
  return result;
}

template <int Dim>
std::vector<double> times(const SquareMatrix<element_unknowns<Dim>>& matrix,
                          const std::array<double, element_unknowns<Dim>>& x) {
  std::vector<double> result(x.size(), 0.0);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < x.size(); ++j) result[i] += matrix[i * x.size() + j] * x[j];
  return result;
}

template <class T>
class ElementMatricesTest : public testing::Test {};
TYPED_TEST_SUITE(ElementMatricesTest, test::Dimensions);

TYPED_TEST(ElementMatricesTest, AgreeWithBruteForce) {
  constexpr int Dim = TypeParam::value;
  constexpr int corners = corner_count<Dim>;
  const Pair<Dim> pair;
  const auto& e = pair.expected;
  const auto stiffness = e.template matrix<corners * Dim>([&](int i, int j) { return e.stiffness(i, j); });
  const auto conductivity = e.template matrix<corners>([&](int i, int j) { return e.conductivity(i, j); });
  const auto mass = e.template matrix<corners>([&](int i, int j) { return e.mass(i, j); });
  EXPECT_LT(test::relative_difference(pair.element.stiffness(), stiffness), 1e-14);
  EXPECT_LT(test::relative_difference(pair.element.conductivity(), conductivity), 1e-14);
  EXPECT_LT(test::relative_difference(pair.element.mass(false), mass), 1e-14);
}

TYPED_TEST(ElementMatricesTest, AreSymmetric) {
  constexpr int Dim = TypeParam::value;
  constexpr int unknowns = element_unknowns<Dim>;
  const Pair<Dim> pair;
  for (int i = 0; i < unknowns; ++i)
    for (int j = 0; j < i; ++j)
      EXPECT_NEAR(pair.element.stiffness()[i * unknowns + j], pair.element.stiffness()[j * unknowns + i],
                  1e-15);
}

TYPED_TEST(ElementMatricesTest, RigidMotionsHaveNoEnergy) {
  constexpr int Dim = TypeParam::value;
  const Pair<Dim> pair;
  for (int a = 0; a < Dim; ++a) {
    const auto translation = corner_values<Dim>([&](const Point<Dim>&) {
      Point<Dim> u{};
      u[a] = 1.0;
      return u;
    });
    EXPECT_LT(test::largest(times<Dim>(pair.element.stiffness(), translation)), 1e-14);
    for (int b = 0; b < a; ++b) {
      const auto rotation = corner_values<Dim>([&](const Point<Dim>& x) {
        Point<Dim> u{};
        u[a] = x[b];
        u[b] = -x[a];
        return u;
      });
      EXPECT_LT(test::largest(times<Dim>(pair.element.stiffness(), rotation)), 1e-14);
    }
  }
}

TYPED_TEST(ElementMatricesTest, LumpedMassKeepsTheVolume) {
  constexpr int Dim = TypeParam::value;
  constexpr int corners = corner_count<Dim>;
  const Pair<Dim> pair;
  double volume = pair.thickness;
  for (const double edge : Pair<Dim>::edges()) volume *= edge;
  for (int i = 0; i < corners; ++i)
    for (int j = 0; j < corners; ++j)
      EXPECT_NEAR(pair.element.mass(true)[i * corners + j], i == j ? volume / corners : 0.0, 1e-15);
}

/// A stress-free linear field has the strain as its gradient, so its nodal forces are the strain's load.
TYPED_TEST(ElementMatricesTest, StrainLoadIsStiffnessTimesTheLinearField) {
  constexpr int Dim = TypeParam::value;
  const Pair<Dim> pair;
  const std::vector<double> strain = test::some_strain<Dim>();
  const auto tensor = test::strain_tensor<Dim>(strain);
  const auto linear = corner_values<Dim>([&](const Point<Dim>& x) {
    Point<Dim> u{};
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) u[a] += tensor[a][b] * x[b];
    return u;
  });
  const auto load = pair.element.strain_load(strain);
  EXPECT_LT(test::relative_difference(load, times<Dim>(pair.element.stiffness(), linear)), 1e-13);
  for (int i = 0; i < element_unknowns<Dim>; ++i)
    EXPECT_NEAR(load[i], pair.expected.strain_load(i, tensor), 1e-16);

  const auto stress = test::stress_voigt<Dim>(pair.expected.stress(tensor));
  EXPECT_LT(test::relative_difference(pair.element.stress(strain), stress), 1e-14);
  EXPECT_LT(test::relative_difference(pair.element.center_stress(linear), stress), 1e-13);
}

TYPED_TEST(ElementMatricesTest, CenterGradientIsExactForLinearFields) {
  constexpr int Dim = TypeParam::value;
  const Pair<Dim> pair;
  for (int along = 0; along < Dim; ++along)
    for (int axis = 0; axis < Dim; ++axis) {
      double slope = 0.0;
      for (int corner = 0; corner < corner_count<Dim>; ++corner)
        slope += pair.element.center_gradient()[corner * Dim + axis] * ((corner >> along) & 1) *
                 Pair<Dim>::edges()[along];
      EXPECT_NEAR(slope, along == axis ? 1.0 : 0.0, 1e-15);
    }
}

TEST(ElementMatrices, PlaneStressContractsFreely) {
  // Uniaxial stress 1 along x: strains (1, -nu) / E, no stress across.
  const ElementMatrices<2> element({1.0, 1.0}, 1.0, poisson);
  const std::vector<double> strain = {1.0, -poisson, 0.0};
  const auto stress = element.stress(strain);
  EXPECT_NEAR(stress[0], 1.0, 1e-15);
  EXPECT_NEAR(stress[1], 0.0, 1e-15);
  // Pure shear: G = E / (2 (1 + nu)).
  const std::vector<double> shear = {0.0, 0.0, 1.0};
  EXPECT_NEAR(element.stress(shear)[2], 1.0 / 2.6, 1e-15);
}

TEST(ElementMatrices, ThicknessMultipliesEveryIntegral) {
  const ElementMatrices<2> thin({0.7, 1.9}, 1.0, poisson);
  const ElementMatrices<2> thick({0.7, 1.9}, 3.0, poisson);
  const std::vector<double> strain = test::some_strain<2>();
  const auto tripled = [](auto values) {
    for (double& value : values) value *= 3.0;
    return values;
  };
  EXPECT_LT(test::relative_difference(thick.stiffness(), tripled(thin.stiffness())), 1e-15);
  EXPECT_LT(test::relative_difference(thick.conductivity(), tripled(thin.conductivity())), 1e-15);
  EXPECT_LT(test::relative_difference(thick.mass(false), tripled(thin.mass(false))), 1e-15);
  EXPECT_LT(test::relative_difference(thick.mass(true), tripled(thin.mass(true))), 1e-15);
  EXPECT_LT(test::relative_difference(thick.strain_load(strain), tripled(thin.strain_load(strain))), 1e-15);
  EXPECT_EQ(thick.center_gradient(), thin.center_gradient());
}

}  // namespace
}  // namespace fabseq
