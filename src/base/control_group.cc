// SPDX-License-Identifier: MIT
#include "base/control_group.h"

#include "fabseq/base/plain_numbers.h"
#include "fabseq/base/posix_file.h"

#include <algorithm>
#include <sstream>
#include <string_view>

namespace fabseq {

namespace {

constexpr std::int64_t no_memory_limit = std::int64_t{1} << 60;  ///< version 1 writes about 2^63

std::vector<std::string> words_of(const std::string& text, char separator) {
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, separator);) result.push_back(word);
  return result;
}

bool names(const std::string& list, const std::string& word) {
  const std::vector<std::string> words = words_of(list, ',');
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string without_end_of_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

template <class Number>
std::optional<Number> number_in_file(const std::string& path) {
  return number_in<Number>(without_end_of_line(read_file_if_there(path)));
}

/// A line of /proc/self/mountinfo: what of the file system is mounted, where, and its type and options.
struct Mount {
  std::string part, place, type, options;
};

std::optional<Mount> mount_of(const std::string& line) {
  const std::vector<std::string> words = words_of(line, ' ');
  const auto end = std::find(words.begin(), words.end(), "-");  // of the optional fields
  if (words.size() < 6 || words.end() - end < 4) return std::nullopt;
  return Mount{words[3], words[4], end[1], end[3]};
}

/// Cores' time of one group.
std::optional<double> quota_of(const std::string& folder, bool unified) {
  std::optional<double> quota, period;
  if (unified) {
    const std::vector<std::string> words =
        words_of(without_end_of_line(read_file_if_there(folder + "/cpu.max")), ' ');
    if (words.size() != 2) return std::nullopt;
    quota = number_in<double>(words[0]);  // or "max"
    period = number_in<double>(words[1]);
  } else {
    quota = number_in_file<double>(folder + "/cpu.cfs_quota_us");  // -1: none
    period = number_in_file<double>(folder + "/cpu.cfs_period_us");
  }
  if (!quota || !period || *quota <= 0.0 || *period <= 0.0) return std::nullopt;
  return *quota / *period;
}

/// Bytes of files in memory that were not used lately, by the group and those below it.
std::int64_t cached_bytes(const std::string& folder, bool unified) {
  for (const std::string& line : words_of(read_file_if_there(folder + "/memory.stat"), '\n')) {
    const std::string_view name = unified ? "inactive_file " : "total_inactive_file ";
    if (line.rfind(name, 0) == 0)
      return number_in<std::int64_t>(std::string_view(line).substr(name.size())).value_or(0);
  }
  return 0;
}

std::optional<MemoryLimit> memory_of(const std::string& folder, bool unified) {
  const auto limit =
      number_in_file<std::int64_t>(folder + (unified ? "/memory.max" : "/memory.limit_in_bytes"));
  const auto used =
      number_in_file<std::int64_t>(folder + (unified ? "/memory.current" : "/memory.usage_in_bytes"));
  if (!limit || *limit <= 0 || *limit >= no_memory_limit) return std::nullopt;
  const std::int64_t kept = std::max<std::int64_t>(0, used.value_or(0) - cached_bytes(folder, unified));
  return MemoryLimit{*limit, std::max<std::int64_t>(0, *limit - kept)};
}

}  // namespace

ControlGroup::ControlGroup(const std::string& controller, const std::string& root) {
  std::optional<std::string> first, second;  // its path in a hierarchy of version 1, in that of version 2
  for (const std::string& line : words_of(read_file_if_there(root + "/proc/self/cgroup"), '\n')) {
    const std::size_t name = line.find(':'), path = line.find(':', name + 1);  // number:controllers:path
    if (name == std::string::npos || path == std::string::npos) continue;
    const std::string controllers = line.substr(name + 1, path - name - 1);
    if (names(controllers, controller)) first = line.substr(path + 1);
    if (controllers.empty()) second = line.substr(path + 1);
  }
  unified_ = !first;
  const std::string path = first.value_or(second.value_or(""));
  if (path.empty()) return;
  for (const std::string& line : words_of(read_file_if_there(root + "/proc/self/mountinfo"), '\n')) {
    const std::optional<Mount> mount = mount_of(line);
    if (!mount ||
        !(unified_ ? mount->type == "cgroup2" : mount->type == "cgroup" && names(mount->options, controller)))
      continue;
    // Without a name space of its own, a container mounts its group alone, but has the whole path.
    const bool whole = mount->part == "/";
    const bool inside = whole || path == mount->part || path.rfind(mount->part + '/', 0) == 0;
    std::string below = inside ? path.substr(whole ? 0 : mount->part.size()) : "";
    if (below.find("..") != std::string::npos) below.clear();  // the group is above the mount
    while (!below.empty() && below.back() == '/') below.pop_back();
    for (;; below.erase(below.rfind('/'))) {
      folders_.push_back(root + mount->place + below);
      if (below.empty()) return;
    }
  }
}

std::optional<double> cpu_quota(const std::string& root) {
  const ControlGroup group("cpu", root);
  std::optional<double> least;
  for (const std::string& folder : group.folders()) {
    const std::optional<double> quota = quota_of(folder, group.unified());
    if (quota && (!least || *quota < *least)) least = quota;
  }
  return least;
}

std::optional<MemoryLimit> memory_limit(const std::string& root) {
  const ControlGroup group("memory", root);
  std::optional<MemoryLimit> least;
  for (const std::string& folder : group.folders()) {
    const std::optional<MemoryLimit> limit = memory_of(folder, group.unified());
    if (!limit) continue;
    if (!least) least = limit;
    least = MemoryLimit{std::min(least->limit, limit->limit), std::min(least->available, limit->available)};
  }
  return least;
}

}  // namespace fabseq
