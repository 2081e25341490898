// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// The control groups of Linux in which this process runs, as a container or a batch system sets them up: its
/// own and those above it, each of which may limit a resource. Both versions are read. Not collective.
class ControlGroup {
 public:
  /// `controller`: "cpu" or "memory". `root` goes before all paths, for tests.
  explicit ControlGroup(const std::string& controller, const std::string& root = "");

  /// Whether it is version 2, with other names of files.
  bool unified() const { return unified_; }
  /// Folders of the groups, the process's own first; none if there is none, or it cannot be seen.
  const std::vector<std::string>& folders() const { return folders_; }

 private:
  bool unified_ = false;
  std::vector<std::string> folders_;
};

/// So many cores' time the process and others of its control groups may take together, such as 0.5; none
/// without a limit (`cpu.max`, `cpu.cfs_quota_us`).
std::optional<double> cpu_quota(const std::string& root = "");

struct MemoryLimit {
  std::int64_t limit = 0;      ///< bytes
  std::int64_t available = 0;  ///< bytes that are not in use; what caches would give back counts as free
};
/// The limit of the control groups with the least available memory (`memory.max`, `memory.limit_in_bytes`);
/// none without one.
std::optional<MemoryLimit> memory_limit(const std::string& root = "");

}  // namespace fabseq
