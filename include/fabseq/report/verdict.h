// SPDX-License-Identifier: MIT
/// \file
/// One verdict on a sequence: whether the machine of the config can build it.
#pragma once

#include "fabseq/report/build_class.h"

#include <string>
#include <vector>

namespace fabseq {

/// The same on all ranks.
struct Verdict {
  std::vector<BrokenLimit> broken;  ///< largest share first
  BuildClass build_class = BuildClass::buildable;
  std::int64_t places = 0;  ///< at which the checks fail

  /// Strictly: nothing is wrong at any place.
  bool buildable() const { return broken.empty(); }
  /// The class: "buildable but for 2 places".
  std::string class_words() const { return words_of(build_class, places); }
  /// The same; what is not buildable with the words of all limits that are broken: "not buildable: ...".
  std::string words() const;
};

/// Judges by the limits that findings say are broken, and by the places, of which the class follows. Not
/// collective.
Verdict judge(const Found& found, const ModelSettings& settings);

/// A share as percents, never 0 where it is not: "34 %", "0.02 %".
std::string percent_words(double share);
/// "near [1,2,3]" of a place.
std::string near_words(const std::vector<double>& at);
/// A length with its unit, where it has one.
std::string length_words(double length, const std::string& unit);

}  // namespace fabseq
