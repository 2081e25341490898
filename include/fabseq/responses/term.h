// SPDX-License-Identifier: MIT
/// \file
/// A term of the objective or a constraint, as the config describes it.
#pragma once

#include "fabseq/base/json.h"

#include <string>

namespace fabseq {

class ResponseType;

enum class TermScaling { first, current };

struct Term {
  const ResponseType* type = nullptr;  ///< owned by the registry; never null in a config that was read
  // For objective terms; constraints have the defaults.
  double weight = 1.0;
  double normalize = 100.0;
  TermScaling scaling = TermScaling::first;
  Json keys;  ///< the completed config object; each type reads its own keys from it
};

}  // namespace fabseq
