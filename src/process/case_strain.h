// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/strain_cases.h"
#include "fabseq/process/strain_source.h"

#include <span>

namespace fabseq {

/// The strains of a source with factors on their components: those of a strain case, or of a combination of
/// cases. The inputs are the source's.
template <int Dim>
class CaseStrain : public StrainSource<Dim> {
 public:
  /// The source must outlive the object.
  CaseStrain(const StrainSource<Dim>& source, const StrainFactors<Dim>& factors)
      : source_(source), factors_(factors) {}

  StrainVariation variation() const override { return source_.variation(); }
  void set_strains(std::span<const int> elements, const StepBlock& steps,
                   std::span<double> strains) const override;
  std::size_t input_count() const override { return source_.input_count(); }
  void add_derivatives(std::span<const int> elements, const StepBlock& steps,
                       std::span<const double> d_strains, std::span<double> d_inputs) const override;

 private:
  /// Multiplies values, [element][Voigt][step], by the factors.
  void scale(const StepBlock& steps, std::span<double> values) const;

  const StrainSource<Dim>& source_;
  StrainFactors<Dim> factors_;
};

}  // namespace fabseq
