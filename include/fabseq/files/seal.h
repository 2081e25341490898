// SPDX-License-Identifier: MIT
/// \file
/// A checksum of a whole file at its end, behind what the file's own format looks at. Nothing here is
/// collective.
#pragma once

#include "fabseq/base/posix_file.h"

#include <cstdint>
#include <string>

namespace fabseq {

/// Appends the seal to a file of `bytes` bytes, open for reading and writing.
void seal_file(const PosixFile& file, std::int64_t bytes);
/// Copies a file but for its seal; false if it does not end in one that is right. Throws OutputError if it
/// cannot be read or there is not enough memory.
bool copy_if_intact(const std::string& path, const MemoryFile& copy);

}  // namespace fabseq
