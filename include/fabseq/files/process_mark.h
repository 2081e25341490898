// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

namespace fabseq {

/// What tells a process from all others, on this machine and on others: for a file that says whose something
/// is.
class ProcessMark {
 public:
  /// The mark of this process.
  static ProcessMark own();
  /// Reads what text() wrote; none from another text.
  static std::optional<ProcessMark> parse(const std::string& text);

  /// Two lines: the name of the process, and what is_alive() needs.
  std::string text() const;
  /// "host node7, since 2026-11-30 09:26:53 UTC, process 4711"
  const std::string& name() const { return name_; }

  /// Whether the process is still there: neither ended, nor replaced by another of the same number. None if
  /// that cannot be seen from here, because it is a process of another machine or container, or the machine
  /// has been started again since.
  std::optional<bool> is_alive() const;
  /// Whether the process is one of another machine, as both the host's name and the kernel say.
  bool is_elsewhere() const;

 private:
  std::string name_;
  std::string host_;
  int process_ = 0;
  std::string boot_;       ///< the kernel's name for the time since the machine was started
  std::string container_;  ///< the name space in which process_ is a number
  std::string start_;      ///< of the process, in clock ticks since the machine was started
};

}  // namespace fabseq
