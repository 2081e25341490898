// SPDX-License-Identifier: MIT
/// \file
/// Check of a single value against its declaration.
#pragma once

#include "fabseq/keys/config_key.h"

#include <string>

namespace fabseq {

/// What a value is checked against besides its key.
struct ValueContext {
  int dimension;          ///< of the domain, 2 or 3
  std::string directory;  ///< absolute; relative paths refer to it
};

/// Throws InputError: what was found at `pointer`, and what the key takes.
[[noreturn]] void refuse_value(const ConfigKey& key, const Json& value, const std::string& pointer,
                               const ValueContext& context);

/// The value of a key that holds no objects (a number, a word, a list of numbers, ...): integers as such,
/// paths absolute. Throws InputError.
Json checked_value(const ConfigKey& key, const Json& value, const std::string& pointer,
                   const ValueContext& context);

}  // namespace fabseq
