// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

namespace fabseq {

/// Metres in a unit of length: um, mm, cm, m, in, ft, and their names in one or several, British or American,
/// in any case; none for other texts.
std::optional<double> metres_in(const std::string& unit);

}  // namespace fabseq
