/// \file
/// The record of a run, iteration by iteration.
#pragma once

#include "fabseq/io/json.h"
#include "fabseq/io/output_directory.h"

namespace fabseq {

/// history.jsonl: one JSON object a line (its keys: docs/users-guide.md, output directory).
class History {
 public:
  /// `directory` is not owned and must outlive the history. A file that is there is continued.
  explicit History(const OutputDirectory& directory) : directory_(directory) {}

  /// Appends `entry` (rank 0's) as one line, which other programs can read when the call returns. Throws
  /// OutputError on all ranks if it could not be written. Collective.
  void append(const Json& entry) const;

 private:
  const OutputDirectory& directory_;
};

}  // namespace fabseq
