// SPDX-License-Identifier: MIT
#include "fabseq/report/real_layers.h"

#include "fabseq/base/formatted.h"

namespace fabseq {

std::string words_of(const RealLayers& layers) {
  std::string grid;
  for (const int count : layers.elements) grid += (grid.empty() ? "" : " x ") + std::to_string(count);
  return formatted("judged by %d real layers, %d to a simulated one, on %s elements, %.2g to a bead; the ",
                   layers.count, layers.passes, grid.c_str(), layers.per_bead) +
         "simulated layers are " + layers.simulated.class_words();
}

}  // namespace fabseq
