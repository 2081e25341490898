// SPDX-License-Identifier: MIT
#include "fabseq/base/input_file.h"

#include "fabseq/base/refusal.h"

#include <cerrno>
#include <cstring>
#include <sys/stat.h>
#include <unistd.h>

namespace fabseq {

std::string reading_problem(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::strerror(errno);
  if (S_ISDIR(status.st_mode)) return "is a directory";
  if (!S_ISREG(status.st_mode)) return "is no regular file";
  return ::access(path.c_str(), R_OK) == 0 ? "" : std::strerror(errno);
}

void require_readable(const std::string& pointer, const std::string& path, const std::string& allowed) {
  const std::string problem = reading_problem(path);
  if (!problem.empty()) refuse(pointer, shown(path) + ", which cannot be read (" + problem + ")", allowed);
}

}  // namespace fabseq
