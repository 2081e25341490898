// SPDX-License-Identifier: MIT
#pragma once

#include <mpi.h>

#include <string>
#include <utility>

namespace fabseq {

/// Folder in a run's directory for the run on half the resolution with which it began.
constexpr const char* coarse_folder = "coarse";

/// Creates (collectively, rank 0 does the work) the directory of a run and writes small text files into it.
class OutputDirectory {
 public:
  /// Throws InputError if `path` holds a run already (a config.json) and not `overwrite`; with `overwrite`
  /// removes what an earlier run left there (only files and folders a run writes, and a file `stop` or
  /// `output_now`). Throws OutputError if it cannot be made or written to. Collective.
  OutputDirectory(MPI_Comm comm, const std::string& path, bool overwrite);
  /// The directory of a run that goes on there: what it left stays, but for its summary.json and for files
  /// that it did not complete. Throws OutputError if it cannot be written to. Collective.
  static OutputDirectory continued(MPI_Comm comm, const std::string& path);

  /// Removes what runs on coarser grids have left in it, as the constructor does with what the run itself
  /// left. Collective.
  void remove_coarse_runs() const;

  MPI_Comm comm() const { return comm_; }
  const std::string& path() const { return path_; }
  std::string file(const std::string& name) const { return path_ + "/" + name; }
  /// Makes a folder in it, if it is not there yet. Throws OutputError on all ranks if that fails, as it does
  /// where the directory itself has vanished. Collective.
  void make_folder(const std::string& name) const;
  /// Writes a file whole, through a temporary name and a rename, by rank 0; the outcome is known on all
  /// ranks: throws OutputError on all of them if it failed. Collective.
  void write(const std::string& name, const std::string& text) const;
  /// Appends a line to a file and hands it to the operating system, as write(); a line that does not fit is
  /// not there in part either.
  void append_line(const std::string& name, const std::string& line) const;

  /// Whether a file is there, by a look of rank 0. Collective.
  bool has(const std::string& name) const;
  /// Removes a file, if it is there. Collective.
  void remove(const std::string& name) const;

 private:
  OutputDirectory(MPI_Comm comm, std::string path) : comm_(comm), path_(std::move(path)) {}

  MPI_Comm comm_;
  std::string path_;
};

}  // namespace fabseq
