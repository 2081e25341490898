// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

struct zip;
struct zip_source;

namespace fabseq {

/// A ZIP archive in memory, through libzip. Errors are InputError: what is damaged is refused, and files of
/// more than 512 MiB, or 1 GiB in all.
class ZipArchive {
 public:
  /// Opens an archive by its bytes.
  explicit ZipArchive(std::string bytes);

  /// The names of its files, without those of folders.
  const std::vector<std::string>& names() const { return names_; }
  bool has(const std::string& name) const;
  /// The bytes of one of its files.
  std::string read(const std::string& name) const;
  /// The archive's bytes, with one more file or another content of it. The archive ends with that.
  std::string with_file(const std::string& name, const std::string& content) &&;
  /// The archive's bytes as it was opened. The archive ends with that.
  std::string take() &&;

 private:
  struct Discard {
    void operator()(zip* archive) const;
  };
  struct Free {
    void operator()(zip_source* source) const;
  };

  std::string bytes_;
  std::unique_ptr<zip_source, Free> source_;  ///< refers to bytes_
  std::unique_ptr<zip, Discard> archive_;
  std::vector<std::string> names_;
};

}  // namespace fabseq
