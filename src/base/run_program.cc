// SPDX-License-Identifier: MIT
#include "fabseq/base/run_program.h"

#include "fabseq/base/stop.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <spawn.h>
#include <sstream>
#include <string_view>
#include <sys/wait.h>
#include <unistd.h>

namespace fabseq {

namespace {

namespace fs = std::filesystem;

using Clock = std::chrono::steady_clock;

constexpr int wait_milliseconds = 100;
constexpr std::size_t most_text = 1 << 16;  // of what is kept of standard error

/// A pipe whose ends no other program inherits.
struct Pipe {
  std::array<int, 2> ends = {-1, -1};

  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) ends = {-1, -1};
  }
  Pipe(Pipe&&) = delete;
  ~Pipe() {
    close(0);
    close(1);
  }
  void close(int number) {
    if (ends[number] >= 0) (void)::close(ends[number]);
    ends[number] = -1;
  }
};

/// Variables of this process without those of MPI.
std::vector<char*> plain_environment() {
  constexpr std::array<std::string_view, 5> of_mpi = {"MPI", "OMPI_", "PMI", "PRTE_", "HYDRA_"};
  std::vector<char*> result;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    bool is_of_mpi = false;
    for (const std::string_view prefix : of_mpi)
      is_of_mpi = is_of_mpi || std::string_view(*variable).starts_with(prefix);
    if (!is_of_mpi) result.push_back(*variable);
  }
  result.push_back(nullptr);
  return result;
}

/// Starts a program whose standard error is the given descriptor. Returns 0 or the error's number.
int start(const std::vector<std::string>& words, int standard_error, pid_t& process) {
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  if (const int error = ::posix_spawn_file_actions_init(&actions); error != 0) return error;
  (void)::posix_spawn_file_actions_adddup2(&actions, standard_error, STDERR_FILENO);
  (void)::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  (void)::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  const int error = ::posix_spawn(&process, copies.front().c_str(), &actions, nullptr, arguments.data(),
                                  plain_environment().data());
  (void)::posix_spawn_file_actions_destroy(&actions);
  return error;
}

/// Reads to the end of what a process writes. Returns why it had to be ended before, or "".
std::string read_all(int descriptor, pid_t process, double most_seconds, std::string& text) {
  const Clock::time_point begin = Clock::now();
  std::array<char, 4096> room;
  while (true) {
    pollfd waiting{descriptor, POLLIN, 0};
    if (::poll(&waiting, 1, wait_milliseconds) > 0) {
      const ssize_t count = ::read(descriptor, room.data(), room.size());
      if (count == 0 || (count < 0 && errno != EINTR)) return "";
      if (count > 0) text.append(room.data(), static_cast<std::size_t>(count));
      if (text.size() > most_text) text.erase(0, text.size() - most_text);
    }
    const bool is_late = std::chrono::duration<double>(Clock::now() - begin).count() > most_seconds;
    if (!is_late && !stop_requested()) continue;
    (void)::kill(process, SIGKILL);
    return is_late ? "it took too long" : "this run was asked to stop";
  }
}

std::string last_line(const std::string& text) {
  std::istringstream stream(text);
  std::string result;
  for (std::string line; std::getline(stream, line);)
    if (line.find_first_not_of(" \t\r") != std::string::npos) result = line;
  return result;
}

bool is_program(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

std::string run_program(const std::vector<std::string>& words, double most_seconds) {
  Pipe pipe;
  if (pipe.ends[0] < 0) return std::string("no pipe: ") + std::strerror(errno);
  pid_t process = 0;
  if (const int error = start(words, pipe.ends[1], process); error != 0)
    return words.front() + " does not start: " + std::strerror(error);
  pipe.close(1);
  std::string text;
  std::string ended = read_all(pipe.ends[0], process, most_seconds, text);
  int status = 0;
  pid_t waited = 0;
  do waited = ::waitpid(process, &status, 0);
  while (waited < 0 && errno == EINTR);
  if (!ended.empty()) return ended;
  if (waited == process && WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  if (waited == process && WIFSIGNALED(status))
    return words.front() + " was ended by signal " + std::to_string(WTERMSIG(status));
  const std::string line = last_line(text);
  return line.empty() ? words.front() + " ended with status " + std::to_string(WEXITSTATUS(status)) : line;
}

std::string find_tools() {
  const std::string name = "fabseq-tools";
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  std::vector<fs::path> candidates = {folder / name};
  // build/PRESET/fabseq, or a build folder of the user's own.
  for (const fs::path& tree : {folder.parent_path().parent_path(), folder.parent_path()})
    candidates.push_back(tree / "scripts" / name);
  const char* path = std::getenv("PATH");
  std::istringstream places(path == nullptr ? "" : path);
  for (std::string place; std::getline(places, place, ':');)
    if (!place.empty()) candidates.push_back(fs::path(place) / name);
  for (const fs::path& candidate : candidates)
    if (is_program(candidate)) return candidate.string();
  return "";
}

}  // namespace fabseq
