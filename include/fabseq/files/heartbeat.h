// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>
#include <thread>

namespace fabseq {

/// How often a process touches its file, and for how long others watch for that: it leaves room for file
/// systems that are slow. Tests take shorter ones.
struct Pulse {
  std::chrono::milliseconds interval{2000}, patience{10000};
};

/// Shows other machines that a process is alive: for the lifetime of the object, a thread touches an open
/// file every `interval`.
class Heartbeat {
 public:
  /// `descriptor`: of the file; it must stay open as long as the object lives.
  Heartbeat(int descriptor, std::chrono::milliseconds interval);

 private:
  std::jthread thread_;
};

/// Watches a file until it is touched, changed or replaced, and returns true. Returns false if nothing
/// happens within `patience`, or if the file goes.
bool is_touched(const std::string& path, std::chrono::milliseconds patience);

}  // namespace fabseq
