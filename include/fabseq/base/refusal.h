// SPDX-License-Identifier: MIT
/// \file
/// How an invalid value is refused: where it stands, what was found, what is allowed.
#pragma once

#include "fabseq/base/json.h"

#include <string>
#include <vector>

namespace fabseq {

/// The words in one text, with `separator` between them.
std::string join(const std::vector<std::string>& words, const std::string& separator);
/// Text of a value for messages: one line, cut if it is long.
std::string shown(const Json& value);
/// Throws InputError("POINTER: found FOUND; allowed: ALLOWED"). An empty pointer is the whole config.
[[noreturn]] void refuse(const std::string& pointer, const std::string& found, const std::string& allowed);

}  // namespace fabseq
