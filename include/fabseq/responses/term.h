// SPDX-License-Identifier: MIT
/// \file
/// A term of the objective or a constraint, as the config describes it.
#pragma once

#include "fabseq/base/json.h"

#include <string>

namespace fabseq {

class ResponseType;

/// The iteration by whose value an objective term is scaled: the first, or the current one.
enum class TermScaling { first, current };

/// The settings of a term.
struct Term {
  const ResponseType* type = nullptr;  ///< in the registry, not owned; never null in a config that was read
  // Of objective terms; constraints have the defaults.
  double weight = 1.0;       ///< factor of the scaled term
  double normalize = 100.0;  ///< value that the term is scaled to
  TermScaling scaling = TermScaling::first;
  Json keys;  ///< the completed config object; each type reads its own keys from it
};

}  // namespace fabseq
