// SPDX-License-Identifier: MIT
/// \file
/// Check of a single value against its declaration. Nothing here is collective.
#pragma once

#include "fabseq/keys/config_key.h"

#include <string>

namespace fabseq {

/// What a value is checked against besides its key.
struct ValueContext {
  int dimension;          ///< of the domain, 2 or 3
  std::string directory;  ///< absolute path; relative paths in the config refer to it
};

/// Throws InputError, which says what was found at `pointer` and what the key takes.
[[noreturn]] void refuse_value(const ConfigKey& key, const Json& value, const std::string& pointer,
                               const ValueContext& context);

/// The checked value of a key that holds no objects (a number, a word, a list of numbers, ...). Integers come
/// back as integers, paths as absolute paths. Values that hold objects come back unchecked. Throws InputError
/// if the key does not take the value.
Json checked_value(const ConfigKey& key, const Json& value, const std::string& pointer,
                   const ValueContext& context);

}  // namespace fabseq
