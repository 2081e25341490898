// SPDX-License-Identifier: MIT
/// \file
/// What is said first of a finished optimization.
#pragma once

#include "fabseq/report/final_reports.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// A sequence that the optimized one is compared with.
struct ComparedSequence {
  std::string block, title;  ///< in summary.json; for people
  double length = 0.0;       ///< rms displacement of the skin, length unit
  double ratio = 0.0;        ///< that over the optimized sequence's
  bool buildable = false;
};

/// The optimized sequence in binary layers beside the best baseline that can be built and the start, by the
/// rms displacement of the skin after the best rigid fit. The same on all ranks.
struct Headline {
  bool released = false;  ///< whether lengths are after the release, as the objective's are
  double length = 0.0;    ///< of the optimized sequence
  std::optional<ComparedSequence> baseline;  ///< the best that can be built; none: no baseline can
  std::optional<ComparedSequence> planar;    ///< where no baseline can be built
  std::optional<ComparedSequence> start;     ///< none if its solves failed
  std::optional<ScaledDrawing> scaled;  ///< of the buildable one that leaves least, if it beats the sequence
  std::vector<std::string> words;       ///< sentences without a full stop; the first is the headline
};

/// `after_release`: whether the objective measures the released part. `unit`: name of the length unit, may be
/// empty. Not collective.
Headline make_headline(const FinalReports& reports, const SequenceNumbers& planar, bool after_release,
                       const std::string& unit);

}  // namespace fabseq
