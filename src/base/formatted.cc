// SPDX-License-Identifier: MIT
#include "fabseq/base/formatted.h"

#include "fabseq/base/plain_numbers.h"

#include <cstdarg>
#include <cstdio>

namespace fabseq {

std::string formatted(const char* format, ...) {
  const PlainNumbers plain;
  std::va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, arguments)), '\0');
  (void)std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(arguments);
  return text;
}

}  // namespace fabseq
