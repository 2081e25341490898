// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace fabseq {

/// What a file is, by its first bytes, if it is known and no surface that can be read: "a gzip archive,
/// unpack it first". "" for all others.
std::string other_format(std::string_view file);

/// The same by the ending of a file's name, in lower case, such as ".unv".
std::string format_by_ending(std::string_view ending);

}  // namespace fabseq
