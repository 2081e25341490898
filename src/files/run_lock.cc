// SPDX-License-Identifier: MIT
#include "fabseq/files/run_lock.h"

#include "fabseq/base/error.h"
#include "fabseq/base/posix_file.h"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <sys/file.h>
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

/// Opens the file and tries to lock it; `error` is that of the lock, 0 if it was taken. The file stays open
/// for reading only, since one that is open for writing keeps a disk from being made read-only. Network file
/// systems lock only files that are open for writing.
int open_and_lock(const std::string& path, int& error) {
  int descriptor = -1;
  for (const int access : {O_RDONLY, O_RDWR}) {
    if (descriptor >= 0) (void)::close(descriptor);
    descriptor = ::open(path.c_str(), access | O_CREAT | O_CLOEXEC, 0666);
    error = descriptor >= 0 && ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 ? errno : 0;
    if (error != EBADF) break;
  }
  return descriptor;
}

}  // namespace

RunLock::RunLock(const std::string& directory) : path_(directory + "/lock") {
  while (true) {
    int error = 0;
    descriptor_ = open_and_lock(path_, error);
    if (descriptor_ < 0) return;  // whoever writes to the directory says what is wrong with it
    if (error == EWOULDBLOCK) {
      (void)::close(descriptor_);
      const std::string holder = read_file_if_there(path_);
      throw InputError("output directory '" + directory + "' is in use by a run (" +
                       (holder.empty() ? "which has just begun" : holder) +
                       "); allowed: another directory with -output, or this one when that run has ended");
    }
    if (has_name(descriptor_, path_)) break;
    (void)::close(descriptor_);
  }
  const int writable = ::open(path_.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  const std::string holder = this_process();
  (void)!::write(writable, holder.data(), holder.size());
  (void)::close(writable);
}

RunLock::~RunLock() {
  if (descriptor_ < 0) return;
  remove_quietly(path_);
  (void)::close(descriptor_);
}

}  // namespace fabseq
