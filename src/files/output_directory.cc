// SPDX-License-Identifier: MIT
#include "fabseq/files/output_directory.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/verdict.h"

#include <algorithm>
#include <array>
#include <fcntl.h>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

namespace fabseq {

namespace {

namespace fs = std::filesystem;

/// This file marks a directory as that of a run. It is written first and removed last.
constexpr std::string_view mark_of_a_run = "config.json";
/// Files that a run writes (docs/reference.md, output), what tools draw from those of two tasks, and the two
/// by which a user talks to it.
constexpr auto files_of_a_run = std::to_array<std::string_view>(
    {"refined.h5",           "history.jsonl",        "result.h5",           "result.xdmf",
     "summary.json",         "starts.json",          "evaluation.json",     "gradients.h5",
     "checkpoint/slot_0.h5", "checkpoint/slot_1.h5", "checkpoint/newest",   "stop",
     "output_now",           "gradient_check.csv",   "gradient_check.json", "gradient_check.svg",
     "sensitivity.json",     "sensitivity.csv",      "sensitivity.svg",     "beads/config.json",
     "beads/result.h5",      "beads/result.xdmf",    "beads/summary.json",  mark_of_a_run});

[[noreturn]] void fail(const std::string& action, const fs::path& path, const std::string& reason) {
  throw OutputError("cannot " + action + " '" + path.string() + "': " + reason);
}

void remove_file(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);  // a missing file is no error
  if (error) fail("remove", path, error.message());
}

bool is_field_dump(const std::string& name) {
  constexpr std::array<std::string_view, 3> endings = {".bin", ".xdmf", ".partial"};
  return std::any_of(endings.begin(), endings.end(), [&](std::string_view end) {
    return name.starts_with("iteration_") && name.ends_with(end);
  });
}

void remove_run(const fs::path& directory) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory / "fields", error))
    if (is_field_dump(entry.path().filename().string())) remove_file(entry.path());
  for (const std::string_view name : files_of_a_run) {
    remove_file(partial_name((directory / name).string()));
    remove_file(directory / name);
  }
  for (const char* folder : {"fields", "checkpoint", beads_folder})
    fs::remove(directory / folder, error);  // stays if it is not empty
}

/// Removes runs from several designs, and the files of these.
void remove_starts(const fs::path& directory) {
  std::error_code error;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(directory / starts_folder, error))
    found.push_back(entry.path());
  for (const fs::path& path : found) {
    if (fs::exists(path / mark_of_a_run, error)) {
      remove_run(path);
      fs::remove(path, error);
    } else if (path.filename().string().starts_with("start_") && path.extension() == ".h5") {
      remove_file(path);
    }
  }
  fs::remove(directory / starts_folder, error);  // stays if it is not empty
}

/// Removes the runs that others began with, which are nested in each other.
void remove_earlier_runs(const fs::path& directory) {
  std::error_code error;
  remove_starts(directory);
  const fs::path coarse = directory / coarse_folder;
  if (!fs::exists(coarse / mark_of_a_run, error)) return;
  remove_earlier_runs(coarse);
  remove_run(coarse);
  fs::remove(coarse, error);
}

/// Tries to write a file: permissions alone say little (root, read-only mounts, network file systems).
void require_writable(const fs::path& directory) {
  const fs::path probe = directory / ".fabseq_can_write";
  PosixFile(probe.string(), O_WRONLY | O_CREAT | O_TRUNC).close();
  remove_file(probe);
}

std::unique_ptr<const RunLock> set_up(const fs::path& directory, bool overwrite) {
  std::error_code error;
  const fs::file_status status = fs::status(directory, error);
  if (fs::exists(status) && !fs::is_directory(status))
    fail("make output directory", directory, "it is a file");
  if (!fs::exists(status) && fs::is_symlink(fs::symlink_status(directory, error)))
    fail("make output directory", directory,
         "it is a link to '" + fs::read_symlink(directory, error).string() + "', which is not there");
  const bool holds_run = fs::exists(directory / mark_of_a_run, error);
  if (holds_run && !overwrite)
    throw InputError("output directory '" + directory.string() +
                     "' holds a run already; -overwrite replaces it, -output names another directory");
  fs::create_directories(directory, error);
  if (error) fail("make output directory", directory, error.message());
  auto lock = std::make_unique<const RunLock>(directory.string());
  require_writable(directory);
  if (holds_run) remove_run(directory);
  return lock;
}

/// Removes partial files, which are of no use, and the summary, which describes a run that has ended.
std::unique_ptr<const RunLock> prepare_to_continue(const fs::path& directory) {
  auto lock = std::make_unique<const RunLock>(directory.string());
  require_writable(directory);
  for (const std::string_view name : files_of_a_run) remove_file(partial_name((directory / name).string()));
  remove_file(directory / "summary.json");
  return lock;
}

}  // namespace

bool is_file_of_run(const std::string& directory, const std::string& file) {
  std::error_code error;
  const fs::path inside = fs::relative(file, directory, error);
  if (error || inside.empty() || !fs::exists(fs::path(directory) / mark_of_a_run, error)) return false;
  if (*inside.begin() == coarse_folder) return is_file_of_run(directory + "/" + coarse_folder, file);
  if (*inside.begin() == starts_folder) return true;
  return std::ranges::find(files_of_a_run, inside.string()) != files_of_a_run.end();
}

OutputDirectory::OutputDirectory(MPI_Comm comm, const std::string& path, bool overwrite)
    : comm_(comm), path_(path) {
  run_on_first(comm_, [&] { lock_ = set_up(path_, overwrite); });
}

OutputDirectory OutputDirectory::continued(MPI_Comm comm, const std::string& path) {
  OutputDirectory result(comm, path);
  run_on_first(comm, [&] { result.lock_ = prepare_to_continue(path); });
  return result;
}

void OutputDirectory::remove_earlier_runs() const {
  run_on_first(comm_, [&] { fabseq::remove_earlier_runs(path_); });
}

void OutputDirectory::make_folder(const std::string& name) const {
  run_on_first(comm_, [&] {
    std::error_code error;
    fs::create_directory(file(name), error);
    if (error) fail("make folder", file(name), error.message());
  });
}

void OutputDirectory::write(const std::string& name, const std::string& text) const {
  run_on_first(comm_, [&] { replace_file(file(name), text); });
}

bool OutputDirectory::has(const std::string& name) const {
  std::error_code error;
  return any(comm_, rank_of(comm_) == 0 && fs::exists(file(name), error));
}

void OutputDirectory::remove(const std::string& name) const {
  run_on_first(comm_, [&] { remove_file(file(name)); });
}

}  // namespace fabseq
