// SPDX-License-Identifier: MIT
#include "fabseq/files/run_lock.h"

#include "fabseq/base/error.h"
#include "fabseq/base/posix_file.h"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace fabseq {

namespace {

/// "host node7, process 4711"
std::string this_process() {
  std::array<char, 256> host{};
  (void)::gethostname(host.data(), host.size() - 1);
  return "host " + std::string(host.data()) + ", process " + std::to_string(::getpid());
}

/// Whether the file that is open under `descriptor` still has this name: the run that held the lock before
/// may have removed it.
bool has_name(int descriptor, const std::string& path) {
  struct stat of_file {
  }, of_name{};
  return ::fstat(descriptor, &of_file) == 0 && ::stat(path.c_str(), &of_name) == 0 &&
         of_file.st_ino == of_name.st_ino && of_file.st_dev == of_name.st_dev;
}

bool is_held(int error) { return error == EAGAIN || error == EACCES; }

}  // namespace

RunLock::RunLock(const std::string& directory) : path_(directory + "/lock"), descriptor_(-1) {
  while (true) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) return;  // whoever writes to the directory says what is wrong with it
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    if (::fcntl(descriptor_, F_OFD_SETLK, &whole) != 0 && is_held(errno)) {
      (void)::close(descriptor_);
      const std::string holder = read_file_if_there(path_);
      throw InputError("output directory '" + directory + "' is in use by a run (" +
                       (holder.empty() ? "which has just begun" : holder) +
                       "); allowed: another directory with -output, or this one when that run has ended");
    }
    if (has_name(descriptor_, path_)) break;
    (void)::close(descriptor_);
  }
  const std::string holder = this_process();
  (void)!::ftruncate(descriptor_, 0);
  (void)!::pwrite(descriptor_, holder.data(), holder.size(), 0);
}

RunLock::~RunLock() {
  if (descriptor_ < 0) return;
  remove_quietly(path_);
  (void)::close(descriptor_);
}

}  // namespace fabseq
