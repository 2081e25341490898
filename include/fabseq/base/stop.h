// SPDX-License-Identifier: MIT
/// \file
/// Requests to end a run early: signals, a time limit, a file. Long iterations poll for them.
#pragma once

#include <mpi.h>

#include <optional>
#include <string>

namespace fabseq {

/// Listens for signals for the lifetime of the object. Make one at the start of main. SIGUSR1, SIGUSR2 and
/// SIGINT come from a person: the first is noted, and a second one, more than a tenth of a second later, ends
/// the process at once; the delay is needed because some launchers deliver a signal twice. SIGTERM comes from
/// a queue or a launcher, SIGHUP (the terminal is closed), SIGXCPU (the CPU time is nearly over) and SIGPIPE
/// (nobody reads the output any more) from the system: they are noted, however often they come. Those of the
/// system that are ignored at the start stay so. A limit of CPU time that would kill without SIGXCPU is
/// announced by it a little sooner. Writes beyond a limit of file sizes fail.
class StopRequests {
 public:
  /// `max_wall_time`: seconds from the start of the process after which it is asked to stop; none: no limit.
  explicit StopRequests(std::optional<double> max_wall_time);
  StopRequests(StopRequests&&) = delete;
  ~StopRequests();
};

/// Makes the presence of a file a request, too, for the lifetime of the object. If the file holds an integer,
/// the request is made when that many iterations are done, otherwise at once; an empty one is read again
/// after half a second. Stop files of runs within runs are nested.
class StopFile {
 public:
  /// Rank 0 of `comm` looks for the file. Not collective.
  StopFile(MPI_Comm comm, const std::string& path);
  StopFile(StopFile&&) = delete;
  ~StopFile();
};

/// Tells the innermost stop file how many iterations are done, and looks for all stop files without delay.
/// Not collective.
void note_iterations(int done);
/// Removes the files that asked for the stop, on the rank that looks for them. Ignores failures.
void remove_stop_files() noexcept;

/// Whether this rank has been asked to stop; once true, always true. It is cheap: it looks for the files at
/// most once per second. Not collective.
bool stop_requested();
/// Throws Stopped on all ranks of `comm` if any of them has been asked to stop. Collective on `comm`, with
/// one reduction if none has.
void stop_if_requested(MPI_Comm comm);
/// The same for signals alone, by callers that have written nothing yet and leave nothing behind.
void stop_if_signalled(MPI_Comm comm);
/// Throws Stopped, which names the reason, on all ranks of `comm`, for callers whose own reduction has told
/// them that one of these ranks was asked to stop. Collective on `comm`.
[[noreturn]] void throw_stopped(MPI_Comm comm);

/// Seconds of a time given as seconds ("5400", "0.5") or as H:M:S ("1:30:00"); none if the text is neither or
/// the time is not positive.
std::optional<double> parse_duration(const std::string& text);

}  // namespace fabseq
