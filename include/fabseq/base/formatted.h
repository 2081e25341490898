// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace fabseq {

/// Text of values as printf() writes them, of any length, with a decimal point whatever the locale.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

}  // namespace fabseq
