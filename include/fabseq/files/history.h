// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/files/output_directory.h"

#include <cstdint>
#include <string>

namespace fabseq {

/// The file history.jsonl: one JSON object per line (docs/reference.md, output, lists its keys).
class History {
 public:
  /// `directory` must outlive the history. An existing file is continued.
  explicit History(const OutputDirectory& directory) : directory_(directory) {}

  /// Appends `entry` of rank 0 as one line, which other programs can read when the call returns. Throws
  /// OutputError on all ranks if the line could not be written. Collective on the directory's communicator.
  void append(const Json& entry) const;

  /// Syncs all lines to the disk and returns the size of the file, bytes, which is a position for cut_back().
  /// Collective.
  std::int64_t sync() const;
  /// Cuts the file back to what it was when sync() returned `position`. Warns if it is shorter by now.
  /// Collective.
  void cut_back(std::int64_t position) const;
  /// Replaces the file by the first `position` bytes of the history of another directory. Warns if that
  /// history is shorter. Collective.
  void copy_from(const std::string& directory, std::int64_t position) const;

 private:
  const OutputDirectory& directory_;
};

}  // namespace fabseq
