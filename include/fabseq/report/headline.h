// SPDX-License-Identifier: MIT
/// \file
/// What is said first of a finished optimization.
#pragma once

#include "fabseq/report/final_reports.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// A sequence that the optimized one is compared with.
struct ComparedSequence {
  std::string block, title;  ///< in summary.json; for people
  double length = 0.0;       ///< rms displacement of the skin, length unit
  double largest = 0.0;      ///< largest displacement of the skin, length unit
  double ratio = 0.0;        ///< `length` over the optimized sequence's
  std::string class_words;   ///< Verdict::class_words()
  BuildClass build_class = BuildClass::not_buildable;
};

/// The optimized sequence in binary layers beside the best alternative and the start, by the displacement of
/// the skin after the best rigid fit. Alternatives are baselines of the same class or a better one; roofs
/// that hang in every sequence do not count there. The same on all ranks.
struct Headline {
  bool released = false;  ///< whether lengths are after the release, as the objective's are
  double length = 0.0;    ///< rms of the optimized sequence
  double largest = 0.0;
  BuildClass build_class = BuildClass::not_buildable;
  std::optional<ComparedSequence> alternative;  ///< the best one; none: all baselines are of a worse class
  ComparedSequence planar;                      ///< today's way
  std::optional<ComparedSequence> start;        ///< none if its solves failed
  std::optional<ScaledDrawing> scaled;          ///< of the rival that leaves least, if it beats the sequence
  std::vector<std::string> words;               ///< sentences without a full stop; the first is the headline
  std::vector<std::string> places;  ///< of the optimized sequence, those that no sequence shares first
};

/// Not collective.
Headline make_headline(const FinalReports& reports, const SequenceNumbers& planar,
                       const ModelSettings& settings);

}  // namespace fabseq
