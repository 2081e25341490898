// SPDX-License-Identifier: MIT
/// \file
/// One verdict on a sequence: whether the machine of the config can build it.
#pragma once

#include "fabseq/report/build_class.h"

#include <string>
#include <vector>

namespace fabseq {

/// A limit of the machine that a sequence does not keep, by the exact checks of its binary layers
/// (docs/formulation.md 13.1).
struct BrokenLimit {
  std::string name;        ///< local_thickness, tilt, blocked or hanging, as in `checks` of summary.json
  double share = 0.0;      ///< of the part's volume
  double worst = 0.0;      ///< thickness over the target, degrees, length; of hanging elements their number
  std::vector<double> at;  ///< centre of that element, [axis]
  std::string words;  ///< "34 % of the part is out of thickness (worst 3.1 times the target near [1,2,3])"
};

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

/// Judges by the limits that the config gives: what begins in the air, the torch's reach with `tool.profile`,
/// `tool.max_tilt`, and `tool.thickness` where the layers have a target. Not collective.
Verdict judge(const BuildNumbers& numbers, const ModelSettings& settings);

/// A share as percents, never 0 where it is not: "34 %", "0.02 %".
std::string percent_words(double share);
/// "near [1,2,3]" of a place.
std::string near_words(const std::vector<double>& at);
/// A length with its unit, where it has one.
std::string length_words(double length, const std::string& unit);

}  // namespace fabseq
