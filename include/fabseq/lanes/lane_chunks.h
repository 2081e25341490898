// SPDX-License-Identifier: MIT
/// \file
/// Any number of systems side by side, taken in pieces as wide as the lane kernels.
#pragma once

namespace fabseq {

/// Covers `lanes` by chunks of 8, 4, 2 and 1, as few as possible: calls `use(first)`, with the width as its
/// template argument, for the first lane of each.
template <class Use>
void for_lane_chunks(int lanes, Use&& use) {
  int first = 0;
  for (; lanes - first >= 8; first += 8) use.template operator()<8>(first);
  if (lanes - first >= 4) {
    use.template operator()<4>(first);
    first += 4;
  }
  if (lanes - first >= 2) {
    use.template operator()<2>(first);
    first += 2;
  }
  if (lanes - first >= 1) use.template operator()<1>(first);
}

}  // namespace fabseq
