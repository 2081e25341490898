// SPDX-License-Identifier: MIT
#include "report/broken_limit.h"

#include "fabseq/report/verdict.h"

namespace fabseq {

std::optional<BrokenLimit> limit_broken_at(const MarkedElements& marked, BrokenLimit limit,
                                           const std::string& what, const std::string& worst_words) {
  if (marked.elements == 0) return std::nullopt;
  limit.share = marked.share;
  limit.at = marked.at;
  limit.words =
      percent_words(marked.share) + " of the part " + what + " (" + worst_words + near_words(marked.at) + ")";
  return limit;
}

}  // namespace fabseq
