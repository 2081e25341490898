// SPDX-License-Identifier: MIT
/// \file
/// Requests to end a run before its time: signals, a time limit, a file. Whoever iterates for long asks for
/// them.
#pragma once

#include <mpi.h>

#include <optional>
#include <string>

namespace fabseq {

/// Listens for SIGUSR1, SIGUSR2, SIGTERM and SIGINT as long as it lives; make one, first thing in main. The
/// first signal is noted; a second one, more than a tenth of a second later (launchers deliver some twice),
/// ends the process at once.
class StopRequests {
 public:
  /// `max_wall_time`: seconds from the start of the process after which it shall stop.
  explicit StopRequests(std::optional<double> max_wall_time);
  StopRequests(StopRequests&&) = delete;
  ~StopRequests();
};

/// Makes a file a request, too, as long as it lives: at once, or, if the file holds an integer, when that
/// many iterations are done. Stop files of runs within runs are nested.
class StopFile {
 public:
  /// Rank 0 of `comm` looks.
  StopFile(MPI_Comm comm, const std::string& path);
  StopFile(StopFile&&) = delete;
  ~StopFile();
};

/// Says how many iterations are done, for stop files (the innermost) that wait for one, and looks for the
/// files without delay.
void note_iterations(int done);
/// Removes the files that ask for the stop. Rank 0 of StopFile; does not fail.
void remove_stop_files() noexcept;

/// Whether this rank has been asked to stop; once true, always true. Cheap: looks for the file once a second.
bool stop_requested();
/// Throws Stopped on all ranks of `comm` if any of them has been asked. Collective, one reduction.
void stop_if_requested(MPI_Comm comm);
/// For those who have learned by a reduction of their own that a rank of `comm` has been asked: throws
/// Stopped, which names the reason, on all of them. Collective.
[[noreturn]] void throw_stopped(MPI_Comm comm);

/// Seconds of a time given as seconds ("5400", "0.5") or H:M:S ("1:30:00"); none if it is neither, or not
/// positive.
std::optional<double> parse_duration(const std::string& text);

}  // namespace fabseq
