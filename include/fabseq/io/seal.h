/// \file
/// A checksum of a whole file at its end, behind what the file's own format looks at. Nothing here is
/// collective.
#pragma once

#include "fabseq/io/posix_file.h"

#include <cstdint>
#include <string>

namespace fabseq {

/// Appends the seal to a file of `bytes` bytes, open for reading and writing.
void seal_file(const PosixFile& file, std::int64_t bytes);
/// Whether a file ends in a seal that is right. Throws OutputError if it cannot be read.
bool seal_is_intact(const std::string& path);

}  // namespace fabseq
