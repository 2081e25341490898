// SPDX-License-Identifier: MIT
/// \file
/// A term of the objective or a constraint, as the config describes it.
#pragma once

#include <any>
#include <cstddef>

namespace fabseq {

class ResponseType;

/// The iteration by whose value an objective term is scaled: the first, or the current one.
enum class TermScaling { first, current };

/// What counts of a distortion J(u) where the strain is not known exactly (docs/formulation.md 5.1).
enum class Aggregate {
  nominal,  ///< J for the strain as given
  mean,     ///< mean of J(u_s) over the scenarios
  spread,   ///< mean of J(u_s - mean of all u_s)
  worst     ///< largest J(u_s)
};

/// The settings of a term.
struct Term {
  const ResponseType* type = nullptr;  ///< in the registry, not owned; never null in a config that was read
  // Of objective terms; constraints have the defaults.
  double weight = 1.0;       ///< factor of the scaled term
  double normalize = 100.0;  ///< value that the term is scaled to
  TermScaling scaling = TermScaling::first;
  std::size_t position = 0;  ///< in its list of the config
  std::any own;              ///< the type's own settings, such as DistortionSettings
};

}  // namespace fabseq
