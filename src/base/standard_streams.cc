// SPDX-License-Identifier: MIT
#include "fabseq/base/standard_streams.h"

#include "fabseq/base/stop.h"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <poll.h>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>

namespace fabseq {

namespace {

constexpr int moment = 100;  // milliseconds

/// Another way to the same pipe or terminal, on which writes do not wait. The descriptor itself is shared
/// with whoever else writes there and stays as it is. -1 where there is none, or nothing to wait for.
class WithoutWaiting {
 public:
  explicit WithoutWaiting(int descriptor) {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || !(S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode))) return;
    char path[40];
    (void)std::snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
    descriptor_ = ::open(path, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  }
  WithoutWaiting(const WithoutWaiting&) = delete;
  WithoutWaiting& operator=(const WithoutWaiting&) = delete;
  ~WithoutWaiting() {
    if (descriptor_ >= 0) (void)::close(descriptor_);
  }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
};

/// Whether there may be room now; false if it is not worth waiting any more.
bool wait_for_room(int descriptor) {
  const bool stops = stop_requested();
  pollfd waiting{descriptor, POLLOUT, 0};
  const int ready = ::poll(&waiting, 1, moment);
  return ready > 0 || !stops;
}

}  // namespace

void write_text(int descriptor, const std::string& text) noexcept {
  (void)std::fflush(descriptor == STDERR_FILENO ? stderr : stdout);
  const WithoutWaiting other(descriptor);
  const int target = other.descriptor() >= 0 ? other.descriptor() : descriptor;
  std::string_view rest = text;
  while (!rest.empty()) {
    const ssize_t written = ::write(target, rest.data(), rest.size());
    if (written > 0) rest.remove_prefix(static_cast<std::size_t>(written));
    if (written >= 0 || errno == EINTR) continue;
    if (errno != EAGAIN || !wait_for_room(target)) return;
  }
}

}  // namespace fabseq
