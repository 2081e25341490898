// SPDX-License-Identifier: MIT
#include "fabseq/base/posix_file.h"

#include "fabseq/base/error.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

[[noreturn]] void fail(const std::string& action, const std::string& path, int reason) {
  throw OutputError("cannot " + action + " '" + path + "': " + std::strerror(reason));
}

void sync_parent_directory(const std::string& path) {
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  PosixFile(parent.empty() ? "." : parent.string(), O_RDONLY | O_DIRECTORY).sync();
}

}  // namespace

PosixFile::PosixFile(const std::string& path, int flags)
    : path_(path), descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail("open", path_, errno);
}

PosixFile::~PosixFile() {
  if (descriptor_ >= 0) (void)::close(descriptor_);
}

void PosixFile::write(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("write", path_, written < 0 ? errno : ENOSPC);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void PosixFile::write_at(std::int64_t offset, const void* bytes, std::size_t count) const {
  const char* next = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = ::pwrite(descriptor_, next, count, offset);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("write", path_, written < 0 ? errno : ENOSPC);
    next += written;
    offset += written;
    count -= static_cast<std::size_t>(written);
  }
}

std::size_t PosixFile::read_at(std::int64_t offset, void* bytes, std::size_t count) const {
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got = ::pread(descriptor_, static_cast<char*>(bytes) + done, count - done,
                                offset + static_cast<std::int64_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("read", path_, errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

void PosixFile::resize(std::int64_t bytes) const {
  if (::ftruncate(descriptor_, bytes) != 0) fail("write", path_, errno);
}

void PosixFile::reserve(std::int64_t bytes) const {
  if (bytes == 0 || ::fallocate(descriptor_, 0, 0, bytes) == 0) return;
  if (errno != EOPNOTSUPP && errno != ENOSYS && errno != EINVAL) fail("write", path_, errno);
  const std::vector<char> zeros(1 << 20);
  const auto block = static_cast<std::int64_t>(zeros.size());
  for (std::int64_t offset = 0; offset < bytes; offset += block)
    write_at(offset, zeros.data(), static_cast<std::size_t>(std::min(block, bytes - offset)));
}

void PosixFile::sync() const {
  // EINVAL means something that cannot be synced, such as a directory of some network file systems.
  if (::fsync(descriptor_) != 0 && errno != EINVAL) fail("write", path_, errno);
  (void)::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_DONTNEED);
}

void PosixFile::close() {
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) fail("write", path_, errno);
}

std::string partial_name(const std::string& path) { return path + ".partial"; }

void replace_file(const std::string& path, std::string_view text) {
  const std::string partial = partial_name(path);
  try {
    PosixFile file(partial, O_WRONLY | O_CREAT | O_TRUNC);
    file.write(text);
    file.sync();
    file.close();
    publish_file(path);
  } catch (const OutputError&) {
    remove_quietly(partial);
    throw;
  }
}

void append_to_file(const std::string& path, std::string_view text) {
  PosixFile file(path, O_WRONLY | O_CREAT | O_APPEND);
  struct stat before {};
  if (::fstat(file, &before) != 0) fail("write", path, errno);
  try {
    file.write(text);
  } catch (const OutputError&) {
    (void)!::ftruncate(file, before.st_size);
    throw;
  }
  file.close();
}

std::int64_t sync_file(const std::string& path, std::int64_t most) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return 0;
  PosixFile file(path, O_WRONLY);
  if (status.st_size > most) file.resize(most);
  file.sync();
  file.close();
  return std::min<std::int64_t>(status.st_size, most);
}

std::string read_file_if_there(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void publish_file(const std::string& path) {
  if (std::rename(partial_name(path).c_str(), path.c_str()) != 0) fail("write", path, errno);
  sync_parent_directory(path);
}

void remove_quietly(const std::string& path) noexcept { (void)::unlink(path.c_str()); }

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
