// SPDX-License-Identifier: MIT
/// \file
/// Checks of keys that hold directions.
#pragma once

#include "fabseq/base/json.h"

#include <string>
#include <vector>

namespace fabseq {

/// Refuses the vector 0 for a key that takes a direction of any length or a word. `direction`: empty for the
/// word. `found`: the key's value. `word`: what is allowed beside vectors, without the outer quotes. Throws
/// InputError. Not collective.
void check_direction(const std::string& pointer, const Json& found, const std::vector<double>& direction,
                     const std::string& word);

}  // namespace fabseq
