// SPDX-License-Identifier: MIT
/// \file
/// A checksum of a whole file at its end, behind what the file's own format looks at. Nothing here is
/// collective.
#pragma once

#include "fabseq/base/posix_file.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace fabseq {

/// 64-bit FNV-1a, which finds damaged bytes in files, not malice, of bytes that come piece by piece; how they
/// are cut into pieces does not matter.
class Checksum {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* byte = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) value_ = (value_ ^ byte[i]) * 0x100000001b3ULL;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// Appends the seal to a file of `bytes` bytes, open for reading and writing.
void seal_file(const PosixFile& file, std::int64_t bytes);
/// Copies a file but for its seal; false if it does not end in one that is right. Throws OutputError if it
/// cannot be read or there is not enough memory.
bool copy_if_intact(const std::string& path, const MemoryFile& copy);

}  // namespace fabseq
