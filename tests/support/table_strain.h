// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/strain_source.h"
#include "support/small_parts.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fabseq::test {

/// Strains from a table of all part elements and steps, whose entries are the inputs.
template <int Dim>
class TableStrain : public StrainSource<Dim> {
 public:
  TableStrain(std::size_t elements, int steps)
      : values(elements * steps * voigt_size<Dim>), steps_(static_cast<std::size_t>(steps)) {}

  void set_strains(std::span<const int> elements, const StepBlock& steps,
                   std::span<double> strains) const override {
    for_each(elements, steps, [&](std::size_t at, std::size_t number) { strains[at] = values[number]; });
  }
  std::size_t input_count() const override { return values.size(); }
  void add_derivatives(std::span<const int> elements, const StepBlock& steps,
                       std::span<const double> d_strains, std::span<double> d_inputs) const override {
    for_each(elements, steps, [&](std::size_t at, std::size_t number) { d_inputs[number] += d_strains[at]; });
  }
  /// Entry of an element in a step.
  double& entry(std::size_t element, int step, int component) {
    return values[place(element, static_cast<std::size_t>(step)) + component];
  }

  std::vector<double> values;  ///< [element][step][Voigt]

 private:
  std::size_t place(std::size_t element, std::size_t step) const {
    return (element * steps_ + step) * voigt_size<Dim>;
  }
  /// Calls f(place in the arrays of a block, number of the entry).
  template <class Function>
  void for_each(std::span<const int> elements, const StepBlock& steps, Function&& f) const {
    std::size_t at = 0;
    for (const int element : elements)
      for (int c = 0; c < voigt_size<Dim>; ++c)
        for (int lane = 0; lane < steps.lanes; ++lane)
          f(at++, place(static_cast<std::size_t>(element), static_cast<std::size_t>(steps.first + lane)) + c);
  }

  std::size_t steps_;
};

/// The strains of some elements, [element][Voigt], in all steps, times factors, [step][Voigt].
template <int Dim>
TableStrain<Dim> product_strain(std::span<const double> of_elements, std::span<const double> of_steps) {
  constexpr std::size_t components = voigt_size<Dim>;
  TableStrain<Dim> result(of_elements.size() / components, static_cast<int>(of_steps.size() / components));
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    const std::size_t step = i / components % (of_steps.size() / components);
    result.values[i] = of_elements[i / of_steps.size() * components + i % components] *
                       of_steps[step * components + i % components];
  }
  return result;
}

/// The strains after a step towards others.
template <int Dim>
TableStrain<Dim> moved(TableStrain<Dim> strains, double step, const TableStrain<Dim>& direction) {
  strains.values = moved(strains.values, step, direction.values);
  return strains;
}

}  // namespace fabseq::test
