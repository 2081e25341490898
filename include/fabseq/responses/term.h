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

/// A term of the objective or a constraint. Copies share the type.
struct Term {
  const ResponseType* type = nullptr;  ///< owned by the registry; never null in a config that was read
  // Of objective terms; constraints have the defaults.
  double weight = 1.0;       ///< factor of the scaled term
  double normalize = 100.0;  ///< value that the term is scaled to
  TermScaling scaling = TermScaling::first;
  Json keys;  ///< the completed config object; each type reads its own keys from it
};

}  // namespace fabseq
