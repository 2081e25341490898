// SPDX-License-Identifier: MIT
/// \file
/// Files for HDF5 that are in memory: there nothing fails that would on a disk. HDF5 does not survive a file
/// that cannot be written or closed; what it then keeps of it crashes the process at its end.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace fabseq {

/// A file without a name, gone with the object. Nothing here is collective.
class MemoryFile {
 public:
  MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile();

  /// A path under which this process can open it.
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }
  std::int64_t size() const;
  /// Whether all of `bytes` could be read, or written.
  bool read_at(std::int64_t offset, std::span<char> bytes) const;
  bool write_at(std::int64_t offset, std::span<const char> bytes) const;

 private:
  int descriptor_;
};

}  // namespace fabseq
