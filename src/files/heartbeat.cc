// SPDX-License-Identifier: MIT
#include "fabseq/files/heartbeat.h"

#include <condition_variable>
#include <csignal>
#include <fcntl.h>
#include <mutex>
#include <optional>
#include <sys/stat.h>
#include <tuple>
#include <unistd.h>

namespace fabseq {

namespace {

void beat(const std::stop_token& end, int descriptor, std::chrono::milliseconds interval) {
  sigset_t all;
  (void)sigfillset(&all);
  (void)pthread_sigmask(SIG_BLOCK, &all, nullptr);  // signals are for the thread that computes
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any wake;
  while (!wake.wait_for(lock, end, interval, [&] { return end.stop_requested(); }))
    (void)::futimens(descriptor, nullptr);
}

using FileState = std::tuple<ino_t, off_t, time_t, long>;

/// Returns the state of a file that is opened for it: network file systems then ask their server.
std::optional<FileState> state_of(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return std::nullopt;
  struct stat status {};
  const bool known = ::fstat(descriptor, &status) == 0;
  (void)::close(descriptor);
  if (!known) return std::nullopt;
  return FileState(status.st_ino, status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

}  // namespace

Heartbeat::Heartbeat(int descriptor, std::chrono::milliseconds interval)
    : thread_([=](const std::stop_token& end) { beat(end, descriptor, interval); }) {}

bool is_touched(const std::string& path, std::chrono::milliseconds patience) {
  const std::optional<FileState> first = state_of(path);
  const auto end = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    const std::optional<FileState> now = state_of(path);
    if (!now) return false;
    if (now != first) return true;
  }
  return false;
}

}  // namespace fabseq
