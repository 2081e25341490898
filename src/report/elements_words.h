// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/formatted.h"
#include "fabseq/machine/marked_elements.h"
#include "fabseq/report/verdict.h"

#include <string>

namespace fabseq {

/// "3 elements (first near [1,2,3])"
inline std::string elements_words(const MarkedElements& marked, const char* which) {
  return formatted("%lld element%s (%s %s)", static_cast<long long>(marked.elements),
                   marked.elements == 1 ? "" : "s", which, near_words(marked.at).c_str());
}

}  // namespace fabseq
