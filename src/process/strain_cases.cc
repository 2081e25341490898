// SPDX-License-Identifier: MIT
#include "fabseq/process/strain_cases.h"

#include "fabseq/grid/index_box.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// A row counts as a combination of others if this share of it is left.
constexpr double dependent = 1e-10;

template <int Dim>
void add(StrainFactors<Dim>& to, double factor, const StrainFactors<Dim>& from) {
  for (std::size_t c = 0; c < to.size(); ++c) to[c] += factor * from[c];
}

/// A base of the factors that the cases span: each of its vectors is a combination of cases.
template <int Dim>
struct Base {
  struct Vector {
    StrainFactors<Dim> factors;       ///< of length 1, at right angles to the others
    std::vector<double> combination;  ///< [case]
  };
  std::vector<Vector> vectors;

  /// Takes from `rest` what the base holds of it, twice, against rounding; returns it as a combination of
  /// cases.
  std::vector<double> take(StrainFactors<Dim>& rest) const {
    std::vector<double> result(vectors.size(), 0.0);
    for (int pass = 0; pass < 2; ++pass)
      for (const Vector& vector : vectors) {
        const double part = dot(vector.factors, rest);
        add<Dim>(rest, -part, vector.factors);
        for (std::size_t k = 0; k < vector.combination.size(); ++k) result[k] += part * vector.combination[k];
      }
    return result;
  }
};

/// The factors that matter: those of components that the strain has. A strain that turns may have all.
template <int Dim>
StrainFactors<Dim> effective(const StrainFactors<Dim>& factors, const MaterialSettings& material) {
  StrainFactors<Dim> result = factors;
  if (!material.turning_strain)
    for (std::size_t c = 0; c < result.size(); ++c)
      if (material.inherent_strain[c] == 0.0) result[c] = 0.0;
  return result;
}

}  // namespace

template <int Dim>
StrainFactors<Dim> StrainCases<Dim>::factors(std::span<const double> combination) const {
  if (combination.empty()) return cases.front();
  StrainFactors<Dim> result{};
  for (std::size_t k = 0; k < combination.size(); ++k) add<Dim>(result, combination[k], cases[k]);
  return result;
}

template <int Dim>
StrainCases<Dim> strain_cases(const MaterialSettings& material) {
  StrainCases<Dim> result;
  Base<Dim> base;
  // As a combination of the cases; makes it one of them if it is none.
  const auto combination_of = [&](const StrainFactors<Dim>& factors) {
    StrainFactors<Dim> rest = effective<Dim>(factors, material);
    const double size = std::sqrt(dot(rest, rest));
    std::vector<double> combination = base.take(rest);
    const double left = std::sqrt(dot(rest, rest));
    if (left <= dependent * size) return combination;
    typename Base<Dim>::Vector next{rest, combination};
    for (double& value : next.factors) value /= left;
    for (double& value : next.combination) value /= -left;
    next.combination.push_back(1.0 / left);
    base.vectors.push_back(std::move(next));
    if (base.vectors.size() > 1) result.cases.push_back(factors);
    std::vector<double> alone(base.vectors.size(), 0.0);
    alone.back() = 1.0;
    return alone;
  };
  combination_of(result.cases.front());
  for (const std::vector<double>& axes : material.scenarios) {
    StrainFactors<Dim> factors;
    std::ranges::copy(voigt_factors(axes), factors.begin());
    result.scenarios.push_back(combination_of(factors));
  }
  for (auto& combination : result.scenarios) combination.resize(result.cases.size(), 0.0);
  return result;
}

FABSEQ_INSTANTIATE_STRUCT(StrainCases);
FABSEQ_INSTANTIATE_FUNCTION(strain_cases);

}  // namespace fabseq
