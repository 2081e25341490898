// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace fabseq {

/// Text of values as printf() writes them, of any length.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

}  // namespace fabseq
