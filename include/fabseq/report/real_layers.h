// SPDX-License-Identifier: MIT
/// \file
/// What is told of a sequence whose simulated layers stand for several real ones (docs/formulation.md 3.1).
#pragma once

#include "fabseq/report/verdict.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// How far a part distorts, before a release.
struct DistortionLengths {
  std::optional<double> term;  ///< root of the first distortion term; none without one
  double rms = 0.0;            ///< displacement of the part, length unit
};

/// What lumping real layers to simulated ones changes: the sequence and planar layers, simulated in both.
struct Lumping {
  std::vector<int> elements;  ///< of the grid of both, [axis]
  double per_bead = 0.0;      ///< its elements to the height of a bead
  DistortionLengths simulated, real, planar_simulated, planar_real;
};

/// The real layers, each a bead high, by which a sequence is judged. The same on all ranks.
struct RealLayers {
  int passes = 1;                                 ///< of each simulated layer
  int count = 0;                                  ///< of real layers
  std::vector<int> elements;                      ///< of the grid that they are checked on, [axis]
  double per_bead = 0.0;                          ///< its elements to the height of a bead
  Verdict simulated;                              ///< on the simulated layers
  std::optional<Lumping> lumping = std::nullopt;  ///< where it has been simulated
};

/// Says what the verdict goes by: "judged by 36 real layers, 3 to a simulated one, ...". Not collective.
std::string words_of(const RealLayers& layers);
/// Says by how much real layers distort more or less than simulated ones. `unit`: of length. Not collective.
std::string words_of(const Lumping& lumping, const std::string& unit);

}  // namespace fabseq
