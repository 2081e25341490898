// SPDX-License-Identifier: MIT
/// \file
/// A seal: a checksum of a whole file at its end, where the file's own format does not look. Nothing here is
/// collective.
#pragma once

#include "fabseq/base/posix_file.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace fabseq {

/// 64-bit FNV-1a checksum of bytes that come piece by piece; the cuts between the pieces do not matter. It
/// finds damage, not malice.
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

/// Appends the seal to a file of `bytes` bytes, which must be open for reading and writing. Throws
/// OutputError.
void seal_file(const PosixFile& file, std::int64_t bytes);
/// Copies a file without its seal. Returns false if the file does not end with a correct seal. Throws
/// OutputError if the file cannot be read or there is not enough memory.
bool copy_if_intact(const std::string& path, const MemoryFile& copy);

}  // namespace fabseq
