// SPDX-License-Identifier: MIT
#include "fabseq/report/real_layers.h"

#include "fabseq/base/formatted.h"

namespace fabseq {

namespace {

/// "0.61 mm in real layers and 0.55 mm in simulated ones (+10 %)"
std::string compared(double real, double simulated, const std::string& unit) {
  const std::string change =
      simulated > 0.0 ? formatted(" (%+.2g %%)", 100.0 * (real / simulated - 1.0)) : std::string();
  return length_words(real, unit) + " in real layers and " + length_words(simulated, unit) +
         " in simulated ones" + change;
}

}  // namespace

std::string words_of(const RealLayers& layers) {
  std::string grid;
  for (const int count : layers.elements) grid += (grid.empty() ? "" : " x ") + std::to_string(count);
  return formatted("judged by %d real layers, %d to a simulated one, on %s elements, %.2g to a bead; the ",
                   layers.count, layers.passes, grid.c_str(), layers.per_bead) +
         "simulated layers are " + layers.simulated.class_words();
}

std::string words_of(const Lumping& lumping, const std::string& unit) {
  const bool has_term = lumping.real.term && lumping.simulated.term;
  const auto length = [&](const DistortionLengths& lengths) {
    return has_term ? *lengths.term : lengths.rms;
  };
  return std::string("spread by lumping: ") +
         (has_term ? "the first distortion term, as a length, is " : "the part's rms displacement is ") +
         compared(length(lumping.real), length(lumping.simulated), unit) + ", planar " +
         compared(length(lumping.planar_real), length(lumping.planar_simulated), unit) +
         (lumping.per_bead < 1.0
              ? formatted("; with %.2g elements to a bead the grid does not resolve real layers",
                          lumping.per_bead)
              : std::string());
}

}  // namespace fabseq
