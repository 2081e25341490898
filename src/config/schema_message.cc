// SPDX-License-Identifier: MIT
/// How schema and config speak to the user.
#include "fabseq/base/error.h"
#include "fabseq/config/schema.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fabseq {

namespace {

/// Levenshtein's: insertions, deletions and replacements from one word to the other.
std::size_t edit_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i - 1] == to[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[to.size()];
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& words) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : words) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance >= std::min(least, candidate.size())) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

std::string pointer_to(const std::string& pointer, const std::string& member) {
  std::string escaped;
  for (const char character : member) {
    if (character == '~') {
      escaped += "~0";
    } else if (character == '/') {
      escaped += "~1";
    } else {
      escaped += character;
    }
  }
  const std::string quoted = to_text(escaped);  // a line break in a key must not break the message
  return pointer + "/" + quoted.substr(1, quoted.size() - 2);
}

std::string pointer_to(const std::string& pointer, std::size_t index) {
  return pointer + "/" + std::to_string(index);
}

std::string shown(const Json& value) {
  if (value.is_number() && !std::isfinite(value.get<double>())) return std::to_string(value.get<double>());
  constexpr std::size_t longest = 80;
  std::string text = to_text(value);
  if (text.size() <= longest) return text;
  std::size_t end = longest - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U)
    --end;  // keep UTF-8 characters whole
  return text.substr(0, end) + "...";
}

void refuse(const std::string& pointer, const std::string& found, const std::string& allowed) {
  throw InputError((pointer.empty() ? "/" : pointer) + ": found " + found + "; allowed: " + allowed);
}

void refuse_unavailable(const std::string& pointer, const std::string& what, const std::string& allowed) {
  throw InputError(pointer + ": " + what + " is not available in this version; allowed: " + allowed);
}

}  // namespace fabseq
