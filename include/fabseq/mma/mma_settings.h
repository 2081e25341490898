// SPDX-License-Identifier: MIT
/// \file
/// Asymptotes of the method of moving asymptotes.
#pragma once

namespace fabseq {

/// Svanberg 1987; distances are fractions of a variable's range.
struct MmaSettings {
  double asymptote_initial = 0.5;
  double asymptote_increase = 1.2;
  double asymptote_decrease = 0.7;
  double asymptote_floor = 0.1;     ///< least distance of an asymptote from the variable
  double asymptote_ceiling = 10.0;  ///< largest
};

}  // namespace fabseq
