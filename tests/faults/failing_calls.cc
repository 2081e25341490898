// SPDX-License-Identifier: MIT
/// \file
/// Lets one call of the file system fail: a library to be preloaded (LD_PRELOAD) under every rank of a run.
///
/// It counts the calls of each kind that concern files below one directory, and fails those asked for. From
/// the environment:
///
///     FAILING_DIRECTORY   the directory, as the program names it
///     FAILING_REPORT      a folder elsewhere; each rank writes RANK.csv there: kind,number,name of the file,
///     a line a
///                         call, with ",failed" at the end if it did
///     FAILING_RANK        the rank whose call fails
///     FAILING_KIND        open, write, short_write, sync, rename or close
///     FAILING_NUMBER      which call of its kind, from 1; 0 for none
///     FAILING_LASTING     1: all later ones of its kind fail, too
///     FAILING_REASON      errno; EIO unless given
///
/// A short write writes half of its bytes and says so; the next one to the same file fails. A close that
/// fails closes the file, as Linux does.
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <mutex>
#include <string>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

enum Kind { open_call, write_call, sync_call, rename_call, close_call, kinds };
constexpr std::array<const char*, kinds> kind_names = {"open", "write", "sync", "rename", "close"};
constexpr int descriptors = 4096;

template <class Function>
Function original(Function, const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

int number(const char* name, int otherwise) {
  const std::string text = variable(name);
  return text.empty() ? otherwise : std::atoi(text.c_str());
}

/// What of a call has to be done.
enum class Verdict { as_it_is, fail, shorten };

class Plan {
 public:
  static Plan& instance() {
    static Plan plan;
    return plan;
  }

  bool concerns(const char* path) const {
    return path && !directory_.empty() && std::strncmp(path, directory_.c_str(), directory_.size()) == 0;
  }
  void opened(int descriptor, const char* path) {
    if (descriptor >= 0 && descriptor < descriptors) names_[descriptor] = path;
  }
  /// "" if the descriptor is not of a file that counts.
  std::string name(int descriptor) const {
    return descriptor >= 0 && descriptor < descriptors ? names_[descriptor] : "";
  }
  std::string closed(int descriptor) {
    std::string name = this->name(descriptor);
    if (!name.empty()) names_[descriptor].clear();
    return name;
  }

  Verdict judge(Kind kind, const std::string& name) {
    const std::lock_guard lock(mutex_);
    const int call = ++counts_[kind];
    const bool rest_of_a_short_one = kind == write_call && !shortened_.empty() && name == shortened_;
    if (rest_of_a_short_one) shortened_.clear();
    const bool chosen = kind == kind_ && number_ > 0 && (lasting_ ? call >= number_ : call == number_);
    const bool fails = rest_of_a_short_one || (chosen && !short_);
    const bool shortens = chosen && short_ && !rest_of_a_short_one;
    if (shortens) shortened_ = name;
    if (report_) {
      std::fprintf(report_, "%s,%d,%s%s\n", kind_names[kind], call, name.c_str() + directory_.size(),
                   fails || shortens ? ",failed" : "");
      std::fflush(report_);
    }
    if (fails) errno = reason_;
    return fails ? Verdict::fail : shortens ? Verdict::shorten : Verdict::as_it_is;
  }

 private:
  Plan()
      : directory_(variable("FAILING_DIRECTORY")),
        reason_(number("FAILING_REASON", EIO)),
        lasting_(number("FAILING_LASTING", 0) != 0) {
    const std::string rank = variable("OMPI_COMM_WORLD_RANK");
    const std::string report = variable("FAILING_REPORT");
    if (rank.empty() || report.empty()) directory_.clear();
    if (directory_.empty()) return;
    // Not by the name of fopen: the one below would ask for this plan, which is not there yet.
    report_ = original(&std::fopen, "fopen")((report + "/" + rank + ".csv").c_str(), "w");
    if (variable("FAILING_RANK") != rank) return;
    number_ = number("FAILING_NUMBER", 0);
    const std::string kind = variable("FAILING_KIND");
    short_ = kind == "short_write";
    for (int i = 0; i < kinds; ++i)
      if (kind == kind_names[i] || (short_ && i == write_call)) kind_ = i;
  }

  std::string directory_;
  int reason_;
  bool lasting_, short_ = false;
  int kind_ = -1, number_ = 0;
  std::FILE* report_ = nullptr;
  std::array<std::string, descriptors> names_;
  std::array<int, kinds> counts_{};
  std::string shortened_;
  std::mutex mutex_;
};

Plan& plan() { return Plan::instance(); }

bool fails(Kind kind, const std::string& name) {
  return !name.empty() && plan().judge(kind, name) == Verdict::fail;
}

template <class Open>
int open_with(const char* path, Open really_open) {
  if (!plan().concerns(path)) return really_open();
  if (plan().judge(open_call, path) == Verdict::fail) return -1;
  const int descriptor = really_open();
  plan().opened(descriptor, path);
  return descriptor;
}

/// `write_bytes(count)` writes that many of them.
template <class Write>
ssize_t write_with(int descriptor, std::size_t bytes, Write write_bytes) {
  const std::string name = plan().name(descriptor);
  const Verdict verdict = name.empty() ? Verdict::as_it_is : plan().judge(write_call, name);
  if (verdict == Verdict::fail) return -1;
  return write_bytes(verdict == Verdict::shorten ? bytes / 2 : bytes);
}

int mode_of(int flags, std::va_list arguments) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, int) : 0;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const int mode = mode_of(flags, arguments);
  va_end(arguments);
  static const auto next = original(static_cast<int (*)(const char*, int, ...)>(nullptr), "open");
  return open_with(path, [&] { return next(path, flags, mode); });
}

int open64(const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const int mode = mode_of(flags, arguments);
  va_end(arguments);
  static const auto next = original(static_cast<int (*)(const char*, int, ...)>(nullptr), "open64");
  return open_with(path, [&] { return next(path, flags, mode); });
}

std::FILE* fopen(const char* path, const char* mode) {
  static const auto next = original(&fopen, "fopen");
  if (plan().concerns(path) && fails(open_call, path)) return nullptr;
  return next(path, mode);
}

std::FILE* fopen64(const char* path, const char* mode) {
  static const auto next = original(&fopen64, "fopen64");
  if (plan().concerns(path) && fails(open_call, path)) return nullptr;
  return next(path, mode);
}

int mkdir(const char* path, mode_t mode) {
  static const auto next = original(&mkdir, "mkdir");
  return plan().concerns(path) && fails(open_call, path) ? -1 : next(path, mode);
}

ssize_t write(int descriptor, const void* bytes, std::size_t count) {
  static const auto next = original(&write, "write");
  return write_with(descriptor, count, [&](std::size_t some) { return next(descriptor, bytes, some); });
}

ssize_t pwrite(int descriptor, const void* bytes, std::size_t count, off_t offset) {
  static const auto next = original(&pwrite, "pwrite");
  return write_with(descriptor, count,
                    [&](std::size_t some) { return next(descriptor, bytes, some, offset); });
}

ssize_t pwrite64(int descriptor, const void* bytes, std::size_t count, off64_t offset) {
  static const auto next = original(&pwrite64, "pwrite64");
  return write_with(descriptor, count,
                    [&](std::size_t some) { return next(descriptor, bytes, some, offset); });
}

ssize_t writev(int descriptor, const iovec* pieces, int count) {
  static const auto next = original(&writev, "writev");
  const std::size_t some = count > 1 ? static_cast<std::size_t>(count) : 0;
  return write_with(descriptor, some, [&](std::size_t pieces_to_write) {
    return next(descriptor, pieces, pieces_to_write == some ? count : static_cast<int>(pieces_to_write));
  });
}

ssize_t pwritev(int descriptor, const iovec* pieces, int count, off_t offset) {
  static const auto next = original(&pwritev, "pwritev");
  const std::size_t some = count > 1 ? static_cast<std::size_t>(count) : 0;
  return write_with(descriptor, some, [&](std::size_t pieces_to_write) {
    return next(descriptor, pieces, pieces_to_write == some ? count : static_cast<int>(pieces_to_write),
                offset);
  });
}

int ftruncate(int descriptor, off_t size) noexcept {
  static const auto next = original(&ftruncate, "ftruncate");
  return fails(write_call, plan().name(descriptor)) ? -1 : next(descriptor, size);
}

int ftruncate64(int descriptor, off64_t size) noexcept {
  static const auto next = original(&ftruncate64, "ftruncate64");
  return fails(write_call, plan().name(descriptor)) ? -1 : next(descriptor, size);
}

int fallocate(int descriptor, int mode, off_t offset, off_t size) {
  static const auto next = original(&fallocate, "fallocate");
  return fails(write_call, plan().name(descriptor)) ? -1 : next(descriptor, mode, offset, size);
}

int fallocate64(int descriptor, int mode, off64_t offset, off64_t size) {
  static const auto next = original(&fallocate64, "fallocate64");
  return fails(write_call, plan().name(descriptor)) ? -1 : next(descriptor, mode, offset, size);
}

int fsync(int descriptor) {
  static const auto next = original(&fsync, "fsync");
  return fails(sync_call, plan().name(descriptor)) ? -1 : next(descriptor);
}

int fdatasync(int descriptor) {
  static const auto next = original(&fdatasync, "fdatasync");
  return fails(sync_call, plan().name(descriptor)) ? -1 : next(descriptor);
}

int rename(const char* from, const char* to) noexcept {
  static const auto next = original(&rename, "rename");
  return plan().concerns(to) && fails(rename_call, to) ? -1 : next(from, to);
}

int close(int descriptor) {
  static const auto next = original(&close, "close");
  const std::string name = plan().closed(descriptor);
  const bool shall_fail = !name.empty() && fails(close_call, name);
  const int result = next(descriptor);
  if (!shall_fail) return result;
  errno = EIO;
  return -1;
}

}  // extern "C"
