// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>
#include <thread>

namespace fabseq {

/// Shows other machines that a process is alive: for the lifetime of the object, a thread touches an open
/// file every `interval`.
class Heartbeat {
 public:
  static constexpr std::chrono::seconds interval{2};
  /// How long to watch for a change. It leaves room for file systems that are slow.
  static constexpr std::chrono::seconds patience{10};

  /// `descriptor`: of the file; it must stay open as long as the object lives.
  explicit Heartbeat(int descriptor);

 private:
  std::jthread thread_;
};

/// Watches a file until it is touched, changed or replaced, and returns true. Returns false if nothing
/// happens within Heartbeat::patience, or if the file goes.
bool is_touched(const std::string& path);

}  // namespace fabseq
