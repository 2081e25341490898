// SPDX-License-Identifier: MIT
/// \file
/// The file history.jsonl of a run's directory: one JSON object per line (docs/developer/files.md lists its
/// keys). All calls are collective on the directory's communicator.
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/files/output_directory.h"

#include <cstdint>
#include <string>

namespace fabseq {

/// Appends `entry` of rank 0 as one line, which other programs can read when the call returns. Throws
/// OutputError on all ranks if the line could not be written; no part of it is left then.
void append_to_history(const OutputDirectory& directory, const Json& entry);

/// Syncs all lines to the disk and returns the size of the file, bytes, which is a position for the others.
std::int64_t sync_history(const OutputDirectory& directory);
/// Cuts the file back to what it was when sync_history() returned `position`. Warns if it is shorter by now.
void cut_history(const OutputDirectory& directory, std::int64_t position);
/// Replaces the file by the first `position` bytes of the history of another directory. Warns if that
/// history is shorter.
void copy_history(const OutputDirectory& directory, const std::string& other, std::int64_t position);

}  // namespace fabseq
