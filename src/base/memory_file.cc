// SPDX-License-Identifier: MIT
#include "fabseq/base/memory_file.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace fabseq {

MemoryFile::MemoryFile() : descriptor_(::memfd_create("HDF5", MFD_CLOEXEC)) {}

MemoryFile::~MemoryFile() {
  if (descriptor_ >= 0) (void)::close(descriptor_);
}

std::int64_t MemoryFile::size() const {
  struct stat status {};
  return ::fstat(descriptor_, &status) == 0 ? status.st_size : -1;
}

bool MemoryFile::read_at(std::int64_t offset, std::span<char> bytes) const {
  return ::pread(descriptor_, bytes.data(), bytes.size(), offset) == static_cast<ssize_t>(bytes.size());
}

bool MemoryFile::write_at(std::int64_t offset, std::span<const char> bytes) const {
  return ::pwrite(descriptor_, bytes.data(), bytes.size(), offset) == static_cast<ssize_t>(bytes.size());
}

}  // namespace fabseq
