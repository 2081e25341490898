// SPDX-License-Identifier: MIT
#include "base/busy_time.h"

#include "fabseq/base/plain_numbers.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <sstream>
#include <string_view>

namespace fabseq {

namespace {

/// Times since the machine started, in ticks.
struct Times {
  std::int64_t busy = 0, idle = 0;
};

/// A line per thread: "cpu3 user nice system idle iowait irq softirq steal ...". What follows is part of user
/// and nice; old kernels end earlier.
std::map<int, Times> times_of(const std::string& reading, const ThreadSet& threads) {
  std::map<int, Times> result;
  std::istringstream lines(reading);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, word;
    words >> name;
    const auto thread =
        name.rfind("cpu", 0) == 0 ? number_in<int>(std::string_view(name).substr(3)) : std::nullopt;
    if (!thread || !threads.has(*thread)) continue;
    Times times;
    for (int column = 0; column < 8 && words >> word; ++column) {
      const bool is_idle = column == 3 || column == 4;
      (is_idle ? times.idle : times.busy) += number_in<std::int64_t>(word).value_or(0);
    }
    result[*thread] = times;
  }
  return result;
}

}  // namespace

std::optional<double> busy_share_between(const std::string& before, const std::string& after,
                                         const ThreadSet& threads) {
  std::int64_t busy = 0, idle = 0;
  const std::map<int, Times> first = times_of(before, threads);
  for (const auto& [thread, times] : times_of(after, threads)) {
    const auto then = first.find(thread);
    if (then == first.end()) continue;
    // Kernels may count what waits for disks backwards.
    busy += std::max<std::int64_t>(0, times.busy - then->second.busy);
    idle += std::max<std::int64_t>(0, times.idle - then->second.idle);
  }
  if (busy + idle == 0) return std::nullopt;
  return static_cast<double>(busy) / static_cast<double>(busy + idle);
}

}  // namespace fabseq
