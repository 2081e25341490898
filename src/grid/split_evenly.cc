// SPDX-License-Identifier: MIT
#include "fabseq/grid/decomposition.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fabseq {

namespace {

/// End of the longest range from `start` on whose sum stays within `bound`. `sums`: running sums of the
/// weights.
int longest_range_end(const std::vector<double>& sums, int start, double bound) {
  return static_cast<int>(std::upper_bound(sums.begin() + start, sums.end(), sums[start] + bound) -
                          sums.begin()) -
         1;
}

/// Whether the entries can be split into `parts` ranges of at least one entry with sums within `bound`.
bool can_be_split(const std::vector<double>& sums, int parts, double bound) {
  const int count = static_cast<int>(sums.size()) - 1;
  int start = 0;
  for (int part = 0; part < parts; ++part) {
    const int end = std::min(longest_range_end(sums, start, bound), count - (parts - 1 - part));
    if (end <= start) return false;
    start = end;
  }
  return start == count;
}

/// Smallest bound, up to rounding, for which can_be_split() holds.
double smallest_bound(const std::vector<double>& sums, int parts) {
  double low = 0.0, high = sums.back();
  for (int step = 0; step < 64 && high - low > 1e-12 * sums.back(); ++step) {
    const double middle = 0.5 * (low + high);
    (can_be_split(sums, parts, middle) ? high : low) = middle;
  }
  return high * (1.0 + 1e-12);
}

/// Smallest possible start of each range: from there to the end, all ranges can stay within `bound` and hold
/// at least one entry each.
std::vector<int> smallest_starts(const std::vector<double>& sums, int parts, double bound) {
  std::vector<int> starts(static_cast<std::size_t>(parts) + 1);
  starts[parts] = static_cast<int>(sums.size()) - 1;
  for (int part = parts - 1; part >= 0; --part) {
    const double least = sums[starts[part + 1]] - bound;
    const int fits = static_cast<int>(std::lower_bound(sums.begin(), sums.end(), least) - sums.begin());
    starts[part] = std::min(std::max(fits, part), starts[part + 1] - 1);
  }
  return starts;
}

}  // namespace

std::vector<int> split_evenly(const std::vector<double>& weights, int parts) {
  std::vector<double> sums(weights.size() + 1, 0.0);
  std::partial_sum(weights.begin(), weights.end(), sums.begin() + 1);
  const int count = static_cast<int>(weights.size());
  const double bound = smallest_bound(sums, parts);
  const std::vector<int> smallest = smallest_starts(sums, parts, bound);

  std::vector<int> starts(static_cast<std::size_t>(parts) + 1, 0);
  for (int part = 1; part < parts; ++part) {
    const int low = std::max(smallest[part], starts[part - 1] + 1);
    const int high =
        std::max(low, std::min(longest_range_end(sums, starts[part - 1], bound), count - (parts - part)));
    const double ideal = sums.back() * part / parts;
    starts[part] = low;
    for (int end = low + 1; end <= high; ++end)
      if (std::abs(sums[end] - ideal) < std::abs(sums[starts[part]] - ideal)) starts[part] = end;
  }
  starts[parts] = count;
  return starts;
}

}  // namespace fabseq
