// SPDX-License-Identifier: MIT
#include "fabseq/base/refusal.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"

#include <cmath>

namespace fabseq {

std::string join(const std::vector<std::string>& words, const std::string& separator) {
  std::string result;
  for (const std::string& word : words) result += (result.empty() ? "" : separator) + word;
  return result;
}

std::string shown(const Json& value) {
  if (value.is_number() && !std::isfinite(value.get<double>())) return formatted("%f", value.get<double>());
  constexpr std::size_t longest = 80;
  std::string text = to_text(value);
  if (text.size() <= longest) return text;
  std::size_t end = longest - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U)
    --end;  // keep UTF-8 characters whole
  return text.substr(0, end) + "...";
}

void refuse(const std::string& pointer, const std::string& found, const std::string& allowed) {
  throw InputError((pointer.empty() ? "-config" : pointer) + ": found " + found + "; allowed: " + allowed);
}

}  // namespace fabseq
