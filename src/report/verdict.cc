// SPDX-License-Identifier: MIT
#include "fabseq/report/verdict.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/refusal.h"

#include <algorithm>

namespace fabseq {

namespace {

/// "34 % of the part is out of thickness (worst ... near [1,2,3])".
BrokenLimit broken_limit(const char* name, const MarkedElements& marked, double worst, const char* what,
                         const std::string& worst_words) {
  return {name, marked.share, worst, marked.at,
          percent_words(marked.share) + " of the part " + what + " (" + worst_words + near_words(marked.at) +
              ")"};
}

BrokenLimit broken_thickness(const ThicknessRange& range, double target) {
  const double times = range.worst / target;
  // Where the gradient of the time vanishes, the figure means nothing.
  const std::string worst = times < 100.0 ? formatted("worst %.2g times the target ", times) : "worst ";
  const bool is_meeting = range.largest_is_meeting && range.worst == range.largest;
  return broken_limit("local_thickness", *range.outside, times, "is out of thickness",
                      worst + (is_meeting ? "where fronts meet " : ""));
}

}  // namespace

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

Verdict judge(const BuildNumbers& numbers, const ModelSettings& settings) {
  Verdict result;
  const auto fails = [](const MarkedElements& marked) { return marked.elements > 0; };
  const auto& thickness = numbers.local_thickness;
  if (thickness && thickness->outside && fails(*thickness->outside))
    result.broken.push_back(broken_thickness(*thickness, settings.layers.target->value));
  if (numbers.tilt && fails(numbers.tilt->beyond))
    result.broken.push_back(
        broken_limit("tilt", numbers.tilt->beyond, numbers.tilt->largest, "is tilted beyond the limit",
                     formatted("%.3g of %.3g degrees ", numbers.tilt->largest, settings.tool.max_tilt)));
  if (numbers.blocked && fails(*numbers.blocked))
    result.broken.push_back(
        broken_limit("blocked", *numbers.blocked, numbers.blocked->largest, "is out of the torch's reach",
                     "by " + length_words(numbers.blocked->largest, settings.unit) + " "));
  if (fails(numbers.hanging))
    result.broken.push_back(broken_limit("hanging", numbers.hanging,
                                         static_cast<double>(numbers.hanging.elements), "begins in the air",
                                         "first "));
  std::stable_sort(result.broken.begin(), result.broken.end(),
                   [](const BrokenLimit& a, const BrokenLimit& b) { return a.share > b.share; });
  if (!result.buildable()) result.build_class = BuildClass::not_buildable;
  if (numbers.places) {
    result.build_class = class_of(*numbers.places, settings.tool);
    result.places = numbers.places->in_all;
  }
  return result;
}

}  // namespace fabseq
