// SPDX-License-Identifier: MIT
/// \file
/// How a value that cannot be is refused: where it stands, what was found, what is allowed.
#pragma once

#include "fabseq/base/json.h"

#include <string>
#include <vector>

namespace fabseq {

/// The words in one text.
std::string join(const std::vector<std::string>& words, const std::string& separator);
/// A value as it stands in messages: one line, long ones cut.
std::string shown(const Json& value);
/// Throws InputError("POINTER: found FOUND; allowed: ALLOWED").
[[noreturn]] void refuse(const std::string& pointer, const std::string& found, const std::string& allowed);

}  // namespace fabseq
