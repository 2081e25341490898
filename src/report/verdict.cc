// SPDX-License-Identifier: MIT
#include "fabseq/report/verdict.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/refusal.h"

#include <algorithm>

namespace fabseq {

std::string percent_words(double share) {
  const double value = 100.0 * share;
  if (value >= 10.0) return formatted("%.0f %%", value < 100.0 ? std::min(value, 99.0) : value);
  return formatted("%.2g %%", value);
}

std::string near_words(const std::vector<double>& at) {
  std::vector<std::string> coordinates;
  for (const double coordinate : at) coordinates.push_back(formatted("%.4g", coordinate));
  return "near [" + join(coordinates, ",") + "]";
}

std::string length_words(double length, const std::string& unit) {
  return formatted("%.3g", length) + (unit.empty() ? "" : " " + unit);
}

std::string Verdict::words() const {
  if (build_class != BuildClass::not_buildable) return class_words();
  std::vector<std::string> reasons;
  for (const BrokenLimit& limit : broken) reasons.push_back(limit.words);
  return class_words() + ": " + join(reasons, ", ");
}

Verdict judge(const Found& found, const ModelSettings& settings) {
  Verdict result;
  for (const Found::Entry& entry : found.entries())
    if (auto broken = entry.numbers->broken_limit()) result.broken.push_back(*std::move(broken));
  std::sort(result.broken.begin(), result.broken.end(), [](const BrokenLimit& a, const BrokenLimit& b) {
    return a.share != b.share ? a.share > b.share : a.rank < b.rank;
  });
  if (!result.buildable()) result.build_class = BuildClass::not_buildable;
  if (found.places) {
    result.build_class = class_of(*found.places, settings.tool);
    result.places = found.places->in_all;
  }
  return result;
}

}  // namespace fabseq
