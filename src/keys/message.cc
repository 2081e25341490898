// SPDX-License-Identifier: MIT
#include "fabseq/keys/message.h"

#include "fabseq/base/json.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

namespace {

/// Levenshtein distance: number of insertions, deletions and replacements from one word to the other.
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

std::string nearest_word(const std::string& word, const std::vector<std::string>& words,
                         std::optional<std::size_t> most) {
  std::string nearest;
  std::size_t least = most.value_or(std::max<std::size_t>(2, word.size() / 3)) + 1;
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

}  // namespace fabseq
