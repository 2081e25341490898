// SPDX-License-Identifier: MIT
/// \file
/// All sequences that the end of an optimization reports.
#pragma once

#include "fabseq/report/constraint_miss.h"
#include "fabseq/report/layer_changes.h"
#include "fabseq/report/sequence_report.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// A direction of planar layers that was tried.
struct TriedDirection {
  std::vector<double> direction;  ///< of length 1, [axis]
  double tilt = 0.0;              ///< from the plate's normal, degrees
  double length = 0.0;            ///< rms displacement of the skin, length unit
  BuildClass build_class = BuildClass::not_buildable;
};

/// A sequence that others are compared with, beside the planar baseline.
struct Baseline {
  std::string block, title;                ///< key in summary.json; for people
  std::string group;                       ///< prefix of its fields in result.h5; empty: they are not written
  SequenceReport numbers;                  ///< without fields where these are not written
  std::vector<double> direction = {};      ///< of tilted planar layers, of length 1; else empty
  std::vector<TriedDirection> tried = {};  ///< all that it was chosen from
  std::vector<int> tried_on = {};          ///< elements of the grid that they were tried on, [axis]
  /// The best of these on the run's own grid, which it was chosen from then; empty: all were tried there.
  std::vector<TriedDirection> finalists = {};
};

/// The best design's sequence, with the layers it was optimized with and with binary ones; and what it is
/// measured by beside the planar baseline, the binary layers of the design that the config starts from.
struct FinalReports {
  SequenceReport optimized, binary;
  std::optional<RepairReport> repair;   ///< of both; none: nothing was repaired
  std::optional<SequenceReport> start;  ///< none if its solves failed
  std::vector<Baseline> baselines;      ///< without those whose solves failed
  std::vector<ConstraintLimit> limits;  ///< of the constraints
  std::optional<ConstraintMiss> miss;   ///< of the best iterate; none if all constraints hold
  std::int64_t interior_minima = 0;
};

}  // namespace fabseq
