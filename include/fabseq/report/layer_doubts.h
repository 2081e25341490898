// SPDX-License-Identifier: MIT
/// \file
/// What the figures of a sequence leave open about its layers.
#pragma once

#include "fabseq/report/build_report.h"

#include <string>
#include <vector>

namespace fabseq {

/// A line for a gradient that does not belong to its times, one for elements later than the last layer, and
/// one for layers without an end, where there are any. Not collective.
std::vector<std::string> doubts_about_layers(const BuildNumbers& numbers);

}  // namespace fabseq
