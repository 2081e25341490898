// SPDX-License-Identifier: MIT
/// \file
/// Writing small files so that a crash or a full disk never leaves half of one under its final name. Nothing
/// here is collective; all failures are OutputErrors that name the file and the system's reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace fabseq {

/// A file open for writing, closed with the object.
class PosixFile {
 public:
  /// `flags` as for open(2).
  PosixFile(const std::string& path, int flags);
  PosixFile(PosixFile&&) = delete;
  ~PosixFile();

  operator int() const { return descriptor_; }  ///< for system calls
  void write(std::string_view bytes) const;
  void write_at(std::int64_t offset, const void* bytes, std::size_t count) const;
  void resize(std::int64_t bytes) const;
  /// Reads up to that many bytes from `offset` on; how many there were.
  std::size_t read_at(std::int64_t offset, void* bytes, std::size_t count) const;
  /// Takes the room for that many bytes on the disk, so that writing them later cannot find it full; the file
  /// has this size then, and zeros where nothing was written.
  void reserve(std::int64_t bytes) const;
  /// Data are on the disk when it returns; the page cache forgets them, so that the next read comes from
  /// there.
  void sync() const;
  /// Network file systems report a full disk only here.
  void close();

 private:
  std::string path_;
  int descriptor_;
};

/// What a file is called until it is whole.
std::string partial_name(const std::string& path);

/// Writes `text` under the partial name, syncs, and renames to `path`.
void replace_file(const std::string& path, std::string_view text);
/// Appends `text` in one piece; a file that could not take all of it is cut back to what it was.
void append_to_file(const std::string& path, std::string_view text);
/// Cuts a file back to its first `bytes` bytes, on the disk when it returns; a file that is shorter or not
/// there stays so. Returns its size.
std::int64_t cut_file(const std::string& path, std::int64_t bytes);
/// Puts what a file holds on the disk and returns its size; 0 if it is not there.
std::int64_t sync_file(const std::string& path);
/// Text of a file; "" if there is none.
std::string read_file_if_there(const std::string& path);

/// Renames PARTIAL to `path` and syncs the directory, so that the name survives a crash.
void publish_file(const std::string& path);
/// Removes a file that is there; does not fail.
void remove_quietly(const std::string& path) noexcept;

/// A file in memory, without a name, for HDF5: there nothing fails that would on a disk. Gone with the
/// object.
class MemoryFile {
 public:
  MemoryFile();
  MemoryFile(MemoryFile&&) = delete;
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
