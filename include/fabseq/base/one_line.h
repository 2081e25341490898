// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace fabseq {

/// The text with a space for each control character or line break, and a question mark for each byte that is
/// no UTF-8: messages quote what users' files have in them, and are one line all the same.
std::string one_line(std::string_view text);

}  // namespace fabseq
