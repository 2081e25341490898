// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/fem/element_matrices.h"
#include "fabseq/parallel/step_dealing.h"

#include <cstddef>
#include <span>

namespace fabseq {

/// What strains vary with.
enum class StrainVariation {
  none,       ///< the same in all elements and steps
  by_step,    ///< the same in all elements of a step
  by_element  ///< each element may have its own in each step
};

/// The stress-free strains that load a process (docs/formulation.md 4.1): those that the part's elements,
/// full ones, take up in each of its steps, which are the layers. Voigt, engineering shear. All that needs
/// these strains asks their source. Local to the rank.
template <int Dim>
class StrainSource {
 public:
  virtual ~StrainSource() = default;

  /// The same on all ranks. Unless it is by_element, elements count alike, and any number stands for one.
  virtual StrainVariation variation() const { return StrainVariation::by_element; }
  /// Sets the strains of part elements, by their numbers, in a block of steps: [element][Voigt][step].
  virtual void set_strains(std::span<const int> elements, const StepBlock& steps,
                           std::span<double> strains) const = 0;
  /// Number of this rank's inputs: the values that the strains depend on, in an order of the source's own.
  virtual std::size_t input_count() const { return 0; }
  /// The transpose of set_strains(): takes dJ/d(strain), laid out as there, and adds dJ/d(input) to
  /// `d_inputs`, which has an entry per input: this rank's part of the sum over all ranks.
  virtual void add_derivatives(std::span<const int> /*elements*/, const StepBlock& /*steps*/,
                               std::span<const double> /*d_strains*/, std::span<double> /*d_inputs*/) const {}
};

}  // namespace fabseq
