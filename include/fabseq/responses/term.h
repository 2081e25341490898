// SPDX-License-Identifier: MIT
/// \file
/// A term of the objective or a constraint, as the config has it.
#pragma once

#include "fabseq/base/json.h"

#include <string>

namespace fabseq {

class ResponseType;

enum class TermScaling { first, current };

struct Term {
  const ResponseType* type = nullptr;  ///< of the registry, never null in a config that was read
  // The objective's; constraints have the defaults.
  double weight = 1.0;
  double normalize = 100.0;
  TermScaling scaling = TermScaling::first;
  Json keys;  ///< all of them, complete: each type has a section that reads its own
};

}  // namespace fabseq
