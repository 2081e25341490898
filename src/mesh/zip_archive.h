// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
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
  ZipArchive(ZipArchive&&) = delete;

  /// The names of its files, without those of folders.
  const std::vector<std::string>& names() const { return names_; }
  bool has(const std::string& name) const;
  /// The bytes of one of its files.
  std::string read(const std::string& name) const;
  /// An archive that has these files, content by name, too, or another content of them. Its files are not
  /// compressed.
  std::string with_files(const std::map<std::string, std::string>& changed) const;
  /// The archive's bytes. It ends with that.
  std::string take() && {
    archive_.reset();
    return std::move(bytes_);
  }

 private:
  struct Discard {
    void operator()(zip* archive) const;
  };
  struct Free {
    void operator()(zip_source* source) const;
  };

  std::string bytes_;
  std::unique_ptr<zip, Discard> archive_;  ///< refers to bytes_
  std::vector<std::string> names_;
};

}  // namespace fabseq
