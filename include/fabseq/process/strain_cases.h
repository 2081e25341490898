// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/process/process_settings.h"

#include <array>
#include <span>
#include <vector>

namespace fabseq {

/// Factors on the components of the inherent strain, Voigt.
template <int Dim>
using StrainFactors = std::array<double, voigt_size<Dim>>;

template <int Dim>
StrainFactors<Dim> no_change() {
  StrainFactors<Dim> result;
  result.fill(1.0);
  return result;
}

/// The strains that a process is simulated with (docs/formulation.md 4.7). Displacements are linear in the
/// strain and the systems are the same for all: a few cases are solved, and all scenarios are combinations of
/// these. Source: fabseq's own.
template <int Dim>
struct StrainCases {
  /// The first is the strain as given. No case is a combination of others.
  std::vector<StrainFactors<Dim>> cases = {no_change<Dim>()};
  std::vector<std::vector<double>> scenarios;  ///< [scenario][case]

  /// Factors of a combination of the cases; empty: of the first.
  StrainFactors<Dim> factors(std::span<const double> combination) const;
};

/// The cases that the scenarios of a material need: as many as the matrix of their strains and of the strain
/// as given has rank. Not collective.
template <int Dim>
StrainCases<Dim> strain_cases(const MaterialSettings& material);

}  // namespace fabseq
