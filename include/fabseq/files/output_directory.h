// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/files/run_lock.h"

#include <mpi.h>

#include <memory>
#include <string>
#include <utility>

namespace fabseq {

/// Folder, in the directory of a run, for the run at half the resolution with which it began.
constexpr const char* coarse_folder = "coarse";
/// Folder for the real layers of a run whose simulated ones stand for several.
constexpr const char* beads_folder = "beads";
/// Folder for the runs from several designs with which it began, each in a folder named by its number.
constexpr const char* starts_folder = "starts";

/// Whether `file` is one that a run in `directory` has written, which an overwriting run removes. Looks at
/// the file system on the calling rank.
bool is_file_of_run(const std::string& directory, const std::string& file);

/// The directory of a run, which it creates, keeps for itself (RunLock) and writes small text files into.
/// Rank 0 of comm() does the work. Calls that say "collective" are so on comm().
class OutputDirectory {
 public:
  /// Creates the directory. With `overwrite`, removes what an earlier run left there: only files and folders
  /// that a run writes, and the files `stop` and `output_now`. Throws InputError if `path` holds a run
  /// already (a config.json) and `overwrite` is false, or if a run that has not ended holds it. Throws
  /// OutputError if the directory cannot be made or written to. Collective.
  OutputDirectory(MPI_Comm comm, const std::string& path, bool overwrite);
  /// The directory of a run that continues there. What the run left stays, except for its summary.json and
  /// for incomplete files. Throws InputError if a run that has not ended holds the directory, OutputError if
  /// it cannot be written to. Collective.
  static OutputDirectory continued(MPI_Comm comm, const std::string& path);

  /// Removes what the runs with which an earlier one began have left in the directory: those on coarser grids
  /// and those from several designs. Collective.
  void remove_earlier_runs() const;

  MPI_Comm comm() const { return comm_; }
  const std::string& path() const { return path_; }
  /// Path of a file in the directory.
  std::string file(const std::string& name) const { return path_ + "/" + name; }
  /// Makes a folder in the directory if it is not there yet. Throws OutputError on all ranks if that fails,
  /// for example because the directory itself has vanished. Collective.
  void make_folder(const std::string& name) const;
  /// Writes a whole file through a temporary name and a rename. Throws OutputError on all ranks if that
  /// fails. Collective.
  void write(const std::string& name, const std::string& text) const;

  /// Whether rank 0 sees a file of that name; the same on all ranks. Collective.
  bool has(const std::string& name) const;
  /// Removes a file, if it is there. Collective.
  void remove(const std::string& name) const;

 private:
  OutputDirectory(MPI_Comm comm, std::string path) : comm_(comm), path_(std::move(path)) {}

  MPI_Comm comm_;
  std::string path_;
  std::unique_ptr<const RunLock> lock_;  ///< on rank 0
};

}  // namespace fabseq
