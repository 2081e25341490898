// SPDX-License-Identifier: MIT
/// \file
/// What a finding has found about one sequence, in figures and in words.
#pragma once

#include "fabseq/base/json.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

class Found;

/// A sequence's cell of the table that is printed at the end of a run.
struct TableCell {
  int rank = 0;       ///< of its column: those of a smaller rank stand to the left
  std::string title;  ///< of its column
  std::string text;   ///< "-": no value. A column without any value is left out
};

/// A limit of the machine that a sequence does not keep, by the exact checks of its binary layers
/// (docs/formulation.md 13.1).
struct BrokenLimit {
  std::string name;    ///< local_thickness, tilt, blocked or hanging, as in `checks` of summary.json
  double share = 0.0;  ///< of the part's volume
  double worst = 0.0;  ///< thickness over the target, degrees, length; of hanging elements their number
  std::vector<double> at = {};  ///< centre of that element, [axis]
  std::string words = {};  ///< "34 % of the part is tilted beyond the limit (50 of 45 degrees near [1,2])"
  int rank = 0;            ///< of those with equal shares, one of a smaller rank is named first
};

/// Where sentences of a finding stand beside the `words` of summary.json.
enum class ToldIn { summary, table, headline };

/// What a finding has found about one sequence, with all that its words need. The same on all ranks. Nothing
/// here is collective.
class FoundNumbers {
 public:
  virtual ~FoundNumbers() = default;

  /// Adds the figures to the sequence's block of summary.json or evaluation.json.
  virtual void add_record(Json& block) const = 0;
  /// Cells of the printed table. \param all  what all findings have found about the sequence
  virtual std::vector<TableCell> cells(const Found& all) const;
  /// The limit of the machine that the sequence does not keep, for its verdict.
  virtual std::optional<BrokenLimit> broken_limit() const { return std::nullopt; }
  /// Sentences without a full stop, for reports; those of the broken limit if not said otherwise.
  virtual std::vector<std::string> words() const;
  virtual ToldIn told_in() const { return ToldIn::summary; }
  /// Lines that warn of what makes the figures doubtful.
  virtual std::vector<std::string> doubts() const { return {}; }
};

}  // namespace fabseq
