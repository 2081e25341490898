// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/machine/marked_elements.h"
#include "fabseq/report/found_numbers.h"

#include <optional>
#include <string>

namespace fabseq {

/// The limit that marked elements break; none if there are none.
/// \param limit        with name, rank and worst figure
/// \param what         "is out of thickness"
/// \param worst_words  what stands in brackets before the place: "worst 3.1 times the target "
std::optional<BrokenLimit> limit_broken_at(const MarkedElements& marked, BrokenLimit limit,
                                           const std::string& what, const std::string& worst_words);

}  // namespace fabseq
