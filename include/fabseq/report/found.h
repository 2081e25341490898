// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/report/faulty_places.h"
#include "fabseq/report/found_numbers.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// What all findings have found about one sequence, in the order in which they measure. Copies share it. The
/// same on all ranks.
class Found {
 public:
  struct Entry {
    std::string finding;  ///< its name
    std::shared_ptr<const FoundNumbers> numbers;
  };

  void add(const std::string& finding, std::shared_ptr<const FoundNumbers> numbers) {
    entries_.push_back({finding, std::move(numbers)});
  }
  /// Puts what others have found in place of what is here of the same findings, and their places.
  void replace(const Found& others);
  const std::vector<Entry>& entries() const { return entries_; }
  /// The numbers of that type; nullptr if there are none.
  template <class Numbers>
  const Numbers* find() const {
    for (const Entry& entry : entries_)
      if (const auto* numbers = dynamic_cast<const Numbers*>(entry.numbers.get())) return numbers;
    return nullptr;
  }
  /// Sentences of the finding of that name; none if it has found nothing.
  std::vector<std::string> words_of(const std::string& finding) const;
  /// All sentences that are told there.
  std::vector<std::string> words_in(ToldIn place) const;
  /// All lines that warn.
  std::vector<std::string> doubts() const;

  std::optional<FaultyPlaces> places;  ///< check_places() looks for them

 private:
  std::vector<Entry> entries_;
};

}  // namespace fabseq
