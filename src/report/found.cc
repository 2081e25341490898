// SPDX-License-Identifier: MIT
#include "fabseq/report/found.h"

#include <algorithm>
#include <iterator>

namespace fabseq {

std::vector<TableCell> FoundNumbers::cells(const Found& /*all*/) const { return {}; }

std::vector<std::string> FoundNumbers::words() const {
  const auto broken = broken_limit();
  return broken ? std::vector{broken->words} : std::vector<std::string>();
}

void Found::replace(const Found& others) {
  for (const Entry& other : others.entries_) {
    const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const Entry& own) { return own.finding == other.finding; });
    if (entry == entries_.end())
      entries_.push_back(other);
    else
      entry->numbers = other.numbers;
  }
  places = others.places;
}

std::vector<std::string> Found::words_of(const std::string& finding) const {
  const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& other) { return other.finding == finding; });
  return entry == entries_.end() ? std::vector<std::string>() : entry->numbers->words();
}

std::vector<std::string> Found::words_in(ToldIn place) const {
  std::vector<std::string> result;
  for (const Entry& entry : entries_)
    if (entry.numbers->told_in() == place)
      std::ranges::move(entry.numbers->words(), std::back_inserter(result));
  return result;
}

std::vector<std::string> Found::doubts() const {
  std::vector<std::string> result;
  for (const Entry& entry : entries_) std::ranges::move(entry.numbers->doubts(), std::back_inserter(result));
  return result;
}

}  // namespace fabseq
