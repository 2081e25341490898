// SPDX-License-Identifier: MIT
#include "fabseq/report/layer_doubts.h"

#include "fabseq/base/formatted.h"
#include "fabseq/report/verdict.h"

namespace fabseq {

namespace {

/// Share of the part: more is no meeting of fronts.
constexpr double most_elsewhere = 0.25;

/// "3 elements (first near [1,2,3])"
std::string elements_words(const MarkedElements& marked, const char* which) {
  return formatted("%lld element%s (%s %s)", static_cast<long long>(marked.elements),
                   marked.elements == 1 ? "" : "s", which, near_words(marked.at).c_str());
}

}  // namespace

std::vector<std::string> doubts_about_layers(const BuildNumbers& numbers) {
  std::vector<std::string> result;
  if (numbers.gradient_elsewhere > most_elsewhere)
    result.push_back(
        "/sequence/file: the gradient recorded beside the times points elsewhere than these grow at " +
        percent_words(numbers.gradient_elsewhere) + " of the part: it seems to belong to other times");
  if (numbers.late && numbers.late->elements > 0)
    result.push_back("/layers/count: the last layer also holds what comes later, " +
                     elements_words(*numbers.late, "latest") +
                     formatted(": it is up to %.2g times as thick as its pseudo-time says; more layers, or "
                               "thicker ones, reach the part's end",
                               numbers.late->largest + late_from + 1.0));
  const auto& thickness = numbers.local_thickness;
  if (thickness && thickness->without_end.elements > 0)
    result.push_back("local thickness: the pseudo-time hardly changes at " +
                     elements_words(thickness->without_end, "first") +
                     ", whose layers count as thick as the part is long");
  return result;
}

}  // namespace fabseq
