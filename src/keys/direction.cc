// SPDX-License-Identifier: MIT
#include "fabseq/keys/direction.h"

#include "fabseq/base/refusal.h"

#include <algorithm>

namespace fabseq {

void check_direction(const std::string& pointer, const Json& found, const std::vector<double>& direction,
                     const std::vector<std::string>& words) {
  const bool zero =
      std::all_of(direction.begin(), direction.end(), [](double value) { return value == 0.0; });
  if (direction.empty() || !zero) return;
  refuse(pointer, shown(found), "\"" + join(words, "\", \"") + "\" or a vector other than 0");
}

}  // namespace fabseq
