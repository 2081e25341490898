// SPDX-License-Identifier: MIT
#include "fabseq/files/seal.h"

#include "fabseq/base/error.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fcntl.h>
#include <span>
#include <sys/stat.h>
#include <vector>

namespace fabseq {

namespace {

struct Seal {
  std::array<char, 8> mark = {'f', 'a', 'b', 's', 'e', 'q', ' ', '1'};
  std::uint64_t checksum = 0;
};
static_assert(sizeof(Seal) == 16, "written as it lies in memory");

/// Calls `take` for the first bytes of a file, block by block. A shorter file gives fewer bytes.
template <class Take>
std::uint64_t checksum_of_file(const PosixFile& file, std::int64_t bytes, Take&& take) {
  std::vector<char> block(1 << 20);
  Checksum checksum;
  for (std::int64_t offset = 0; offset < bytes;) {
    const auto wanted = std::min<std::int64_t>(bytes - offset, static_cast<std::int64_t>(block.size()));
    const std::size_t got = file.read_at(offset, block.data(), static_cast<std::size_t>(wanted));
    if (got == 0) break;
    checksum.add(block.data(), got);
    take(offset, std::span<const char>(block.data(), got));
    offset += static_cast<std::int64_t>(got);
  }
  return checksum.value();
}

}  // namespace

void seal_file(const PosixFile& file, std::int64_t bytes) {
  Seal seal;
  seal.checksum = checksum_of_file(file, bytes, [](std::int64_t, std::span<const char>) {});
  file.write_at(bytes, &seal, sizeof seal);
}

bool copy_if_intact(const std::string& path, const MemoryFile& copy) {
  PosixFile file(path, O_RDONLY);
  struct stat status {};
  if (::fstat(file, &status) != 0 || status.st_size < static_cast<std::int64_t>(sizeof(Seal))) return false;
  const std::int64_t bytes = status.st_size - static_cast<std::int64_t>(sizeof(Seal));
  Seal expected, found;
  expected.checksum = checksum_of_file(file, bytes, [&](std::int64_t offset, std::span<const char> block) {
    if (!copy.write_at(offset, block))
      throw OutputError("cannot read '" + path + "': not enough memory for a copy of it");
  });
  if (file.read_at(bytes, &found, sizeof found) != sizeof found) return false;
  file.close();
  return std::memcmp(&expected, &found, sizeof found) == 0;
}

}  // namespace fabseq
