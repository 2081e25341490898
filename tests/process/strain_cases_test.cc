// SPDX-License-Identifier: MIT
/// Which strains are solved for, and how scenarios are combined of them (formulation 4.7).
#include "fabseq/process/strain_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fabseq {
namespace {

MaterialSettings material(std::vector<double> strain, std::vector<std::vector<double>> scenarios) {
  MaterialSettings result;
  result.inherent_strain = std::move(strain);
  result.scenarios = std::move(scenarios);
  return result;
}

/// The combinations give the scenarios' factors on the components that the strain has.
template <int Dim>
void expect_combinations(const StrainCases<Dim>& cases, const MaterialSettings& material) {
  ASSERT_EQ(cases.scenarios.size(), material.scenarios.size());
  for (std::size_t s = 0; s < material.scenarios.size(); ++s) {
    const auto& axes = material.scenarios[s];
    ASSERT_EQ(cases.scenarios[s].size(), cases.cases.size());
    const StrainFactors<Dim> factors = cases.factors(cases.scenarios[s]);
    for (int c = 0; c < voigt_size<Dim>; ++c) {
      if (!material.turning_strain && material.inherent_strain[c] == 0.0) continue;
      EXPECT_NEAR(factors[c], c < Dim ? axes[c] : std::sqrt(axes[c - Dim] * axes[(c - Dim + 1) % Dim]), 1e-12)
          << "scenario " << s << ", component " << c;
    }
  }
}

TEST(StrainCases, WithoutScenariosThereIsOne) {
  const auto cases = strain_cases<3>(material({-0.01, -0.01, -0.01, 0, 0, 0}, {}));
  EXPECT_EQ(cases.cases.size(), 1u);
  EXPECT_EQ(cases.factors({}), no_change<3>());
}

TEST(StrainCases, AreAsManyAsTheStrainHasComponents) {
  const auto given = material({-0.01, -0.01, -0.01, 0, 0, 0},
                              {{1, 1, 1}, {1.15, 1, 1}, {1, 1.15, 1}, {1, 1, 1.15}, {0.9, 1.1, 1.05}});
  const auto cases = strain_cases<3>(given);
  EXPECT_EQ(cases.cases.size(), 3u);
  expect_combinations(cases, given);
}

TEST(StrainCases, AreNoMoreThanTheScenariosSpan) {
  const auto given = material({-0.01, -0.02, 0.001}, {{1, 1}, {1.1, 1.1}, {1, 0.8}});
  const auto cases = strain_cases<2>(given);
  EXPECT_EQ(cases.cases.size(), 2u);
  expect_combinations(cases, given);
}

TEST(StrainCases, OfOneComponentAreOne) {
  const auto given = material({0, 0, -0.01, 0, 0, 0}, {{1, 1, 1.2}, {1.3, 1, 0.7}});
  const auto cases = strain_cases<3>(given);
  EXPECT_EQ(cases.cases.size(), 1u);
  expect_combinations(cases, given);
}

TEST(StrainCases, StrainsThatTurnMayHaveAllComponents) {
  auto given = material({}, {{1.15, 1}, {1, 1.15}, {0.9, 1.2}, {1.3, 0.7}});
  given.turning_strain = TurningStrain{-0.01, 0.0};
  const auto cases = strain_cases<2>(given);
  EXPECT_EQ(cases.cases.size(), 3u);
  expect_combinations(cases, given);
}

}  // namespace
}  // namespace fabseq
