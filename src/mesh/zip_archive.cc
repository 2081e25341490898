// SPDX-License-Identifier: MIT
#include "mesh/zip_archive.h"

#include "fabseq/base/error.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <zip.h>

namespace fabseq {

namespace {

constexpr std::uint64_t largest_file = std::uint64_t{512} << 20, largest_sum = std::uint64_t{1} << 30;

[[noreturn]] void refuse(const std::string& reason) {
  throw InputError("cannot be read (" + reason + "), needs an intact 3MF file");
}

struct CloseFile {
  void operator()(zip_file_t* file) const { (void)zip_fclose(file); }
};

}  // namespace

void ZipArchive::Discard::operator()(zip* archive) const { zip_discard(archive); }
void ZipArchive::Free::operator()(zip_source* source) const { zip_source_free(source); }

ZipArchive::ZipArchive(std::string bytes) : bytes_(std::move(bytes)) {
  zip_error_t error;
  zip_error_init(&error);
  const std::unique_ptr<zip_source, Free> source(
      zip_source_buffer_create(bytes_.data(), bytes_.size(), 0, &error));
  if (source == nullptr) refuse("no memory for its archive");
  archive_.reset(zip_open_from_source(source.get(), ZIP_RDONLY, &error));
  const std::string reason = archive_ == nullptr ? zip_error_strerror(&error) : "";
  zip_error_fini(&error);
  if (archive_ == nullptr) refuse("its archive: " + reason);
  zip_source_keep(source.get());  // the archive releases one of two
  std::uint64_t all = 0;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive_.get(), 0); ++i) {
    zip_stat_t entry;
    if (zip_stat_index(archive_.get(), static_cast<zip_uint64_t>(i), 0, &entry) != 0 ||
        (entry.valid & (ZIP_STAT_NAME | ZIP_STAT_SIZE)) != (ZIP_STAT_NAME | ZIP_STAT_SIZE))
      refuse("its archive: " + std::string(zip_strerror(archive_.get())));
    all += std::min(entry.size, largest_sum);
    if (entry.size > largest_file || all > largest_sum)
      throw InputError(
          "has files of more than 512 MiB, or 1 GiB in all, in its archive, which is not allowed");
    const std::string name = entry.name;
    if (!name.ends_with('/')) names_.push_back(name);
  }
}

bool ZipArchive::has(const std::string& name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

std::string ZipArchive::read(const std::string& name) const {
  const std::unique_ptr<zip_file_t, CloseFile> file(zip_fopen(archive_.get(), name.c_str(), 0));
  if (file == nullptr) refuse("\"" + name + "\" in its archive: " + zip_strerror(archive_.get()));
  // What the archive says of a file's size may be wrong.
  std::string content;
  std::array<char, 65536> part;
  zip_int64_t count = 0;
  while ((count = zip_fread(file.get(), part.data(), part.size())) > 0) {
    content.append(part.data(), static_cast<std::size_t>(count));
    if (content.size() > largest_file) refuse("\"" + name + "\" in its archive is longer than it says");
  }
  if (count < 0) refuse("\"" + name + "\" in its archive: " + zip_file_strerror(file.get()));
  return content;
}

std::string ZipArchive::with_files(const std::map<std::string, std::string>& changed) const {
  std::map<std::string, std::string> files = changed;  // libzip reads them at the end
  for (const std::string& name : names_)
    if (!changed.contains(name)) files[name] = read(name);
  zip_error_t error;
  zip_error_init(&error);
  const std::unique_ptr<zip_source, Free> memory(zip_source_buffer_create(nullptr, 0, 0, &error));
  std::unique_ptr<zip, Discard> archive(
      memory == nullptr ? nullptr : zip_open_from_source(memory.get(), ZIP_CREATE | ZIP_TRUNCATE, &error));
  zip_error_fini(&error);
  if (archive == nullptr) refuse("no memory for its archive");
  zip_source_keep(memory.get());  // the archive releases one of two
  for (const auto& [file, bytes] : files) {
    zip_source_t* const added = zip_source_buffer(archive.get(), bytes.data(), bytes.size(), 0);
    const zip_int64_t index =
        added == nullptr ? -1 : zip_file_add(archive.get(), file.c_str(), added, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(added);
      refuse("its archive: " + std::string(zip_strerror(archive.get())));
    }
    (void)zip_set_file_compression(archive.get(), static_cast<zip_uint64_t>(index), ZIP_CM_STORE, 0);
  }
  if (zip_close(archive.get()) != 0) refuse("its archive: " + std::string(zip_strerror(archive.get())));
  (void)archive.release();  // NOLINT(bugprone-unused-return-value): zip_close() has freed it
  zip_stat_t written;
  if (zip_source_stat(memory.get(), &written) != 0 || zip_source_open(memory.get()) != 0)
    refuse("no memory for its archive");
  std::string result(static_cast<std::size_t>(written.size), '\0');
  const zip_int64_t count = zip_source_read(memory.get(), result.data(), result.size());
  (void)zip_source_close(memory.get());
  if (count != static_cast<zip_int64_t>(result.size())) refuse("no memory for its archive");
  return result;
}

}  // namespace fabseq
