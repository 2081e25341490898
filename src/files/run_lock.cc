// SPDX-License-Identifier: MIT
#include "fabseq/files/run_lock.h"

#include "fabseq/base/error.h"
#include "fabseq/base/session.h"

#include <cerrno>
#include <chrono>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace fabseq {

namespace {

/// Whether the file that is open under `descriptor` still has this name: the run that held the lock before
/// may have removed it.
bool has_name(int descriptor, const std::string& path) {
  struct stat of_file {
  }, of_name{};
  return ::fstat(descriptor, &of_file) == 0 && ::stat(path.c_str(), &of_name) == 0 &&
         of_file.st_ino == of_name.st_ino && of_file.st_dev == of_name.st_dev;
}

/// Makes the file, in one step among all machines; false if it is there, or cannot be made.
bool make_file(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor >= 0) (void)::close(descriptor);
  return descriptor >= 0;
}

/// 0 if the open file is locked from now on, EWOULDBLOCK if another process has locked it, or else why it
/// cannot be locked.
int try_lock(int descriptor) {
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return 0;
  if (errno == EWOULDBLOCK || errno == EBADF) return errno;
  struct flock whole_file {};
  whole_file.l_type = F_WRLCK;
  whole_file.l_whence = SEEK_SET;
  if (::fcntl(descriptor, F_OFD_SETLK, &whole_file) == 0) return 0;
  return errno == EACCES ? EWOULDBLOCK : errno;
}

/// Opens the file, null if that is not possible, and tries to lock it. The file stays open for reading only,
/// since one that is open for writing keeps a disk from being made read-only. Network file systems, and
/// fcntl(), lock only files that are open for writing.
std::unique_ptr<const PosixFile> open_and_lock(const std::string& path, int& error) {
  std::unique_ptr<const PosixFile> file;
  try {
    for (const int access : {O_RDONLY, O_RDWR}) {
      file = std::make_unique<const PosixFile>(path, access | O_CREAT);
      error = try_lock(*file);
      if (error != EBADF) break;
    }
  } catch (const OutputError&) {  // whoever writes to the directory says what is wrong with it
  }
  return file;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

[[noreturn]] void refuse_second_run(const std::string& directory, const std::string& mark) {
  throw InputError("output directory '" + directory + "' is in use by a run (" +
                   (mark.empty() ? "which has just begun" : first_line(mark)) +
                   "); allowed: another directory with -output, or this one when that run has ended");
}

void warn_of_first_run(const std::string& directory, const std::string& mark, const std::string& reason) {
  warn(MPI_COMM_SELF, "output directory '" + directory + "': the lock of a run (" +
                          (mark.empty() ? "which did not get far" : first_line(mark)) + ") is taken over. " +
                          reason + ": make sure that it has ended, or both mix their results");
}

/// Throws InputError if the process that the open file names is alive; warns if that cannot be known.
void require_ended(const std::string& directory, const PosixFile& file, const std::string& path,
                   std::chrono::milliseconds patience) {
  const std::string mark = read_file_if_there(path);
  const std::optional<ProcessMark> holder = ProcessMark::parse(mark);
  const std::optional<bool> alive = holder ? holder->is_alive() : std::nullopt;
  if (alive ? *alive : is_touched(path, patience)) refuse_second_run(directory, read_file_if_there(path));
  if (!alive && has_name(file, path))
    warn_of_first_run(directory, mark,
                      "This file system has no locks, and the run has given no sign of life for " +
                          std::to_string(std::chrono::duration_cast<std::chrono::seconds>(patience).count()) +
                          " s");
}

/// Warns if the lock may have been taken only because it is one of this machine.
void warn_if_elsewhere(const std::string& directory, const std::string& mark) {
  const std::optional<ProcessMark> holder = ProcessMark::parse(mark);
  if (holder && holder->is_elsewhere())
    warn_of_first_run(directory, mark,
                      "It ran on another machine, and some file systems lock for one machine only");
}

void write_in_place(const std::string& path, const std::string& text) {
  const int writable = ::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  (void)!::write(writable, text.data(), text.size());
  (void)::close(writable);
}

/// Processes that take over the same file without a lock write it at about the same time: the last one wins.
constexpr std::chrono::seconds until_all_have_written{1};

}  // namespace

RunLock::RunLock(const std::string& directory, Pulse pulse) : path_(directory + "/lock"), pulse_(pulse) {
  while (!take(directory)) {
  }
}

RunLock::~RunLock() {
  if (!file_) return;
  const bool is_mine = heartbeat_ ? read_file_if_there(path_) == mark_.text() : has_name(*file_, path_);
  heartbeat_.reset();
  if (is_mine) remove_quietly(path_);
}

bool RunLock::take(const std::string& directory) {
  const bool is_new = make_file(path_);
  int error = 0;
  file_ = open_and_lock(path_, error);
  if (!file_) return true;
  if (error == EWOULDBLOCK) refuse_second_run(directory, read_file_if_there(path_));
  const bool has_locks = error == 0;
  if (!has_locks && !is_new) require_ended(directory, *file_, path_, pulse_.patience);
  if (!has_name(*file_, path_)) return false;
  if (has_locks && !is_new) warn_if_elsewhere(directory, read_file_if_there(path_));
  write_in_place(path_, mark_.text());
  if (has_locks) return true;
  if (!is_new) {
    std::this_thread::sleep_for(until_all_have_written);
    if (const std::string mark = read_file_if_there(path_); mark != mark_.text())
      refuse_second_run(directory, mark);
  }
  heartbeat_.emplace(*file_, pulse_.interval);
  return true;
}

}  // namespace fabseq
