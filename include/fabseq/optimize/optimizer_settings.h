// SPDX-License-Identifier: MIT
/// \file
/// How a design is optimized, and for how long (docs/formulation.md 9).
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/mma/mma_settings.h"
#include "fabseq/responses/term.h"
#include "fabseq/sequence/sequence_settings.h"

#include <optional>
#include <vector>

namespace fabseq {

template <class Settings>
class Section;

struct OptimizerSettings {
  int max_iterations = 120;
  double change_tolerance = 0.0;
  double objective_tolerance = 0.0;
  int window = 5;  ///< iterations over which both are looked at
  /// Move limits of the config; none: what complete_move_limits() chooses.
  std::optional<double> given_move_limit, given_final_move_limit;
  double move_limit = 0.05, final_move_limit = 0.004;  ///< of the variable's range
  MmaSettings mma;
  double constraint_margin = 0.95;
  int binary_iterations = 0;                         ///< the last ones, judged by binary layers
  int repair_iterations = 0;                         ///< after the last, where limits are still missed
  double repair_share = 0.005;                       ///< of the part, that a repair of layers may move
  int coarse_iterations = 0;                         ///< before the others, at half the resolution
  int coarse_grids = 1;                              ///< among which they are shared out
  Json starts = Json::array();                       ///< values of sequence.initial to try first
  int start_iterations = 15;                         ///< of each of them
  int earlier_iterations = 0, later_iterations = 0;  ///< of other runs, in the schedules of this one
};

/// Section "optimizer". Its texts name all kinds of sequences that are registered.
Section<OptimizerSettings> optimizer_keys();
/// Sets the move limits: as given, or what suits the sequence; at the end of a run less where a term of the
/// objective may reach the optimizer as a sum of squares (docs/formulation.md 9). Not collective.
void complete_move_limits(OptimizerSettings& optimizer, const SequenceSettings& sequence,
                          const std::vector<Term>& objective);

}  // namespace fabseq
