// SPDX-License-Identifier: MIT
#include "process/case_strain.h"

#include "fabseq/grid/index_box.h"

#include <vector>

namespace fabseq {

template <int Dim>
void CaseStrain<Dim>::set_strains(std::span<const int> elements, const StepBlock& steps,
                                  std::span<double> strains) const {
  source_.set_strains(elements, steps, strains);
  if (factors_ != no_change<Dim>()) scale(steps, strains);
}

template <int Dim>
void CaseStrain<Dim>::add_derivatives(std::span<const int> elements, const StepBlock& steps,
                                      std::span<const double> d_strains, std::span<double> d_inputs) const {
  if (factors_ == no_change<Dim>()) {
    source_.add_derivatives(elements, steps, d_strains, d_inputs);
    return;
  }
  std::vector<double> scaled(d_strains.begin(), d_strains.end());
  scale(steps, scaled);
  source_.add_derivatives(elements, steps, scaled, d_inputs);
}

template <int Dim>
void CaseStrain<Dim>::scale(const StepBlock& steps, std::span<double> values) const {
  const auto lanes = static_cast<std::size_t>(steps.lanes);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= factors_[i / lanes % voigt_size<Dim>];
}

FABSEQ_INSTANTIATE_CLASS(CaseStrain);

}  // namespace fabseq
