// SPDX-License-Identifier: MIT
/// \file
/// A file system that lacks locks: to be preloaded (LD_PRELOAD) under a run, or included by a test. NO_LOCKS
/// in the environment says which calls are not implemented: flock, fcntl (its locks of open files), or all of
/// them.
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>

namespace {

bool lacks(const char* kind) {
  const char* lacking = std::getenv("NO_LOCKS");
  return lacking != nullptr && (std::strcmp(lacking, "all") == 0 || std::strcmp(lacking, kind) == 0);
}

}  // namespace

extern "C" {

int flock(int descriptor, int operation) noexcept {
  static const auto next = reinterpret_cast<int (*)(int, int)>(dlsym(RTLD_NEXT, "flock"));
  if (!lacks("flock")) return next(descriptor, operation);
  errno = ENOSYS;
  return -1;
}

int fcntl(int descriptor, int command, ...) {
  static const auto next = reinterpret_cast<int (*)(int, int, void*)>(dlsym(RTLD_NEXT, "fcntl"));
  std::va_list arguments;
  va_start(arguments, command);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  if (command != F_OFD_SETLK || !lacks("fcntl")) return next(descriptor, command, argument);
  errno = ENOSYS;
  return -1;
}

}  // extern "C"
