// SPDX-License-Identifier: MIT
/// \file
/// Writing small files so that a crash or a full disk never leaves half of one under its final name. Nothing
/// here is collective. Failures throw OutputError, which names the file and the system's reason, unless a
/// call says otherwise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

namespace fabseq {

/// An open file; the destructor closes it without looking for errors.
class PosixFile {
 public:
  /// `flags` as for open(2).
  PosixFile(const std::string& path, int flags);
  PosixFile(PosixFile&&) = delete;
  ~PosixFile();

  operator int() const { return descriptor_; }  ///< for system calls
  /// Writes all of `bytes` at the current position.
  void write(std::string_view bytes) const;
  /// Writes `count` bytes at `offset` of the file.
  void write_at(std::int64_t offset, const void* bytes, std::size_t count) const;
  /// Makes the file `bytes` bytes long.
  void resize(std::int64_t bytes) const;
  /// Reads up to `count` bytes from `offset` on and returns how many there were.
  std::size_t read_at(std::int64_t offset, void* bytes, std::size_t count) const;
  /// Allocates room on the disk for `bytes` bytes, so that writing them later cannot find it full. The file
  /// then has this size, with zeros where nothing was written.
  void reserve(std::int64_t bytes) const;
  /// Returns when the data are on the disk. The page cache then drops them, so that the next read comes from
  /// the disk.
  void sync() const;
  /// Closes the file and reports errors: network file systems report a full disk only here.
  void close();

 private:
  std::string path_;
  int descriptor_;
};

/// Name that a file has until it is whole.
std::string partial_name(const std::string& path);

/// Writes `text` under the partial name, syncs, and renames the file to `path`.
void replace_file(const std::string& path, std::string_view text);
/// Appends `text` in one piece. If the file cannot take all of it, it is cut back to what it was.
void append_to_file(const std::string& path, std::string_view text);
/// Cuts a file back to its first `most` bytes if it is longer, syncs it and returns its size; 0 if there is
/// no such file.
std::int64_t sync_file(const std::string& path, std::int64_t most = std::numeric_limits<std::int64_t>::max());
/// Text of a file; "" if there is none or it cannot be read.
std::string read_file_if_there(const std::string& path);

/// Renames the file partial_name(path) to `path` and syncs the directory, so that the name survives a crash.
void publish_file(const std::string& path);
/// Removes a file if it is there. Ignores failures.
void remove_quietly(const std::string& path) noexcept;

/// A file in memory, without a name, for HDF5. Writes to it do not fail as they would on a disk. It ceases to
/// exist with the object.
class MemoryFile {
 public:
  MemoryFile();
  MemoryFile(MemoryFile&&) = delete;
  ~MemoryFile();

  /// Path under which this process can open it.
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }
  /// Size in bytes, -1 on failure.
  std::int64_t size() const;
  /// Reads or writes all of `bytes`. Returns false if not all could be read or written.
  bool read_at(std::int64_t offset, std::span<char> bytes) const;
  bool write_at(std::int64_t offset, std::span<const char> bytes) const;

 private:
  int descriptor_;
};

}  // namespace fabseq
