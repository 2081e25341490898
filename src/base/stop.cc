// SPDX-License-Identifier: MIT
#include "fabseq/base/stop.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/plain_numbers.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <sstream>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace fabseq {

namespace {

using Clock = std::chrono::steady_clock;

struct NamedSignal {
  int number;
  const char* name;
};
constexpr std::array<NamedSignal, 7> stop_signals = {{{SIGUSR1, "USR1"},
                                                      {SIGUSR2, "USR2"},
                                                      {SIGTERM, "TERM"},
                                                      {SIGINT, "INT"},
                                                      {SIGHUP, "HUP"},
                                                      {SIGXCPU, "XCPU"},
                                                      {SIGPIPE, "PIPE"}}};

/// Whether the system sends it.
constexpr bool is_from_system(int signal) {
  return signal == SIGHUP || signal == SIGXCPU || signal == SIGPIPE;
}

/// Whether it may come again and again: nobody's wish to end at once. mpirun hands a queue's TERM on that the
/// ranks have had already, and whoever sends TERM has KILL for what stays.
constexpr bool may_repeat(int signal) { return is_from_system(signal) || signal == SIGTERM; }

// Reasons are numbers, so that ranks can agree on the largest: a signal, which is first_signal and its
// number, takes precedence, then the file, then the time.
constexpr int no_reason = 0, time_reason = 1, file_reason = 2, first_signal = 3;

const Clock::time_point process_start = Clock::now();
constexpr long nanoseconds = 1000000000L;

// What the signal handler knows: the first signal, and when somebody has asked first.
volatile std::sig_atomic_t caught_signal = 0, asked = 0;
volatile std::sig_atomic_t asked_seconds = 0, asked_nanoseconds = 0;

/// A file that may ask for the stop. `path` is empty on ranks that leave looking to another rank.
struct WatchedFile {
  std::string path;
  int iterations = 0;  ///< done by the run that the file belongs to
  bool asked = false;
};

/// What the process looks for beside signals.
struct Watch {
  std::optional<double> max_wall_time;
  std::vector<WatchedFile> files;  ///< the innermost last
  Clock::time_point last_look;
};

Watch& watch() {
  static Watch instance;
  return instance;
}

extern "C" void on_stop_signal(int signal) {
  constexpr long same_request = nanoseconds / 10;
  const int error = errno;
  timespec now{};
  (void)clock_gettime(CLOCK_MONOTONIC, &now);
  if (caught_signal == 0) caught_signal = signal;
  if (may_repeat(signal)) {
    // noted
  } else if (asked == 0) {
    asked = 1;
    asked_seconds = static_cast<std::sig_atomic_t>(now.tv_sec);
    asked_nanoseconds = static_cast<std::sig_atomic_t>(now.tv_nsec);
  } else if ((now.tv_sec - asked_seconds) * nanoseconds + now.tv_nsec - asked_nanoseconds > same_request) {
    (void)std::signal(signal, SIG_DFL);
    (void)raise(signal);  // delivered when this returns
  }
  errno = error;
}

std::string first_word(const std::string& path) {
  std::string word;
  std::ifstream(path) >> word;
  return word;
}

/// A file that is there but cannot be read counts as a request, too.
bool file_asks(const WatchedFile& seen) {
  if (seen.path.empty() || ::access(seen.path.c_str(), F_OK) != 0) return false;
  std::string word = first_word(seen.path);
  if (word.empty()) {  // whoever writes a number there makes an empty file first
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    word = first_word(seen.path);
  }
  const std::optional<int> wanted = number_in<int>(word);
  return !wanted || seen.iterations >= *wanted;
}

void look_for_files(Watch& seen) {
  seen.last_look = Clock::now();
  for (WatchedFile& file : seen.files) file.asked = file.asked || file_asks(file);
}

bool any_file_asks(const Watch& seen) {
  return std::any_of(seen.files.begin(), seen.files.end(),
                     [](const WatchedFile& file) { return file.asked; });
}

bool time_is_up(const Watch& seen) {
  return seen.max_wall_time &&
         std::chrono::duration<double>(Clock::now() - process_start).count() >= *seen.max_wall_time;
}

int own_reason() {
  const Watch& seen = watch();
  if (caught_signal != 0) return first_signal + caught_signal;
  if (time_is_up(seen)) return time_reason;
  return any_file_asks(seen) ? file_reason : no_reason;
}

std::string reason_text(int reason) {
  if (reason == time_reason) return "stopped: -max_wall_time is over";
  if (reason == file_reason) return "stopped by the file 'stop' in the output directory";
  for (const NamedSignal& signal : stop_signals)
    if (first_signal + signal.number == reason) return std::string("stopped by signal ") + signal.name;
  return "stopped";
}

/// Listens for a signal; not for one of the system that is ignored already, as nohup has HUP ignored.
void listen_for(int signal) {
  struct sigaction before {
  }, action{};
  if (is_from_system(signal) && sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN)
    return;
  action.sa_handler = on_stop_signal;
  action.sa_flags = SA_RESTART;  // interrupted writes go on
  (void)sigaction(signal, &action, nullptr);
}

void listen_no_more(int signal) {
  struct sigaction now {};
  if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler == on_stop_signal)
    (void)std::signal(signal, SIG_DFL);
}

/// Linux sends XCPU at the soft limit of CPU time and kills at the hard one. A shell's `ulimit -t` sets both
/// to one value; the soft one then moves a tenth, at most a minute, ahead, in which to write a checkpoint.
void be_warned_of_cpu_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_CPU, &limit) != 0 || limit.rlim_max == RLIM_INFINITY ||
      limit.rlim_cur < limit.rlim_max)
    return;
  limit.rlim_cur = limit.rlim_max - std::min<rlim_t>(60, limit.rlim_max / 10 + 1);
  (void)setrlimit(RLIMIT_CPU, &limit);
}

}  // namespace

StopRequests::StopRequests(std::optional<double> max_wall_time) {
  watch().max_wall_time = max_wall_time;
  for (const NamedSignal& signal : stop_signals) listen_for(signal.number);
  (void)std::signal(SIGXFSZ, SIG_IGN);  // a write beyond `ulimit -f` fails as one to a full disk
  be_warned_of_cpu_limit();
}

StopRequests::~StopRequests() {
  for (const NamedSignal& signal : stop_signals) listen_no_more(signal.number);
  (void)std::signal(SIGXFSZ, SIG_DFL);
  caught_signal = 0;
  asked = 0;
  watch() = Watch();
}

StopFile::StopFile(MPI_Comm comm, const std::string& path) {
  watch().files.push_back({rank_of(comm) == 0 ? path : ""});
}

StopFile::~StopFile() {
  if (!watch().files.empty()) watch().files.pop_back();
}

void note_iterations(int done) {
  Watch& seen = watch();
  if (!seen.files.empty()) seen.files.back().iterations = done;
  look_for_files(seen);
}

void remove_stop_files() noexcept {
  for (const WatchedFile& file : watch().files)
    if (file.asked) (void)::unlink(file.path.c_str());
}

bool stop_requested() {
  Watch& seen = watch();
  if (!seen.files.empty() && !any_file_asks(seen) && Clock::now() - seen.last_look >= std::chrono::seconds(1))
    look_for_files(seen);
  return own_reason() != no_reason;
}

void stop_if_requested(MPI_Comm comm) {
  if (any(comm, stop_requested())) throw_stopped(comm);
}

void stop_if_signalled(MPI_Comm comm) {
  if (any(comm, caught_signal != 0)) throw_stopped(comm);
}

void throw_stopped(MPI_Comm comm) {
  throw Stopped(reason_text(static_cast<int>(max(comm, std::int64_t{own_reason()}))));
}

std::optional<double> parse_duration(const std::string& text) {
  std::vector<double> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ':');) {
    const std::optional<double> value = number_in<double>(part);
    if (!value || !std::isfinite(*value) || *value < 0.0) return std::nullopt;
    parts.push_back(*value);
  }
  if (text.empty() || text.back() == ':' || (parts.size() != 1 && parts.size() != 3)) return std::nullopt;
  double seconds = 0.0;
  for (const double part : parts) seconds = 60.0 * seconds + part;
  return seconds > 0.0 ? std::optional<double>(seconds) : std::nullopt;
}

}  // namespace fabseq
