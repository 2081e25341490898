// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/files/output_directory.h"

#include <cstdint>
#include <string>

namespace fabseq {

/// history.jsonl: one JSON object a line (its keys: docs/reference.md, output).
class History {
 public:
  /// `directory` is not owned and must outlive the history. A file that is there is continued.
  explicit History(const OutputDirectory& directory) : directory_(directory) {}

  /// Appends `entry` (rank 0's) as one line, which other programs can read when the call returns. Throws
  /// OutputError on all ranks if it could not be written. Collective.
  void append(const Json& entry) const;

  /// Puts all lines on the disk and returns the size of the file, a position for cut_back(). Collective.
  std::int64_t sync() const;
  /// Goes back to what the file was when sync() returned `position`, with a warning if it is shorter by now.
  /// Collective.
  void cut_back(std::int64_t position) const;
  /// Begins with the first `position` bytes of the history of another directory. Collective.
  void copy_from(const std::string& directory, std::int64_t position) const;

 private:
  const OutputDirectory& directory_;
};

}  // namespace fabseq
