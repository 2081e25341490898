// SPDX-License-Identifier: MIT
/// \file
/// Checks of keys that hold directions.
#pragma once

#include "fabseq/base/json.h"

#include <string>
#include <vector>

namespace fabseq {

/// Refuses the vector 0 for a key that takes a direction of any length or a word. `direction`: empty for a
/// word. `found`: the key's value. `words`: what is allowed beside vectors. Throws InputError. Not
/// collective.
void check_direction(const std::string& pointer, const Json& found, const std::vector<double>& direction,
                     const std::vector<std::string>& words);

}  // namespace fabseq
