// SPDX-License-Identifier: MIT
#include "fabseq/base/memory.h"

#include "base/control_group.h"
#include "base/node_ranks.h"
#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/plain_numbers.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <sys/resource.h>
#include <unistd.h>

namespace fabseq {

namespace {

std::int64_t sum_over_machines(MPI_Comm comm, std::int64_t bytes) {
  const NodeRanks machine(comm);
  return sum(comm, machine.is_first() ? bytes : 0);
}

/// The sum of what all ranks have; none if one has no bound.
std::optional<std::int64_t> sum_of_bounds(MPI_Comm comm, const std::optional<std::int64_t>& bound) {
  if (any(comm, !bound)) return std::nullopt;
  return sum(comm, *bound);
}

}  // namespace

std::optional<std::int64_t> address_space_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  constexpr rlim_t most = std::numeric_limits<std::int64_t>::max();
  return static_cast<std::int64_t>(std::min(limit.rlim_cur, most));
}

std::optional<std::int64_t> address_space_left() {
  const auto limit = address_space_limit();
  if (!limit) return std::nullopt;
  std::int64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;  // the first number is the size of the address space
  return std::max<std::int64_t>(0, *limit - pages * sysconf(_SC_PAGESIZE));
}

std::string address_space_words() {
  const auto limit = address_space_limit();
  if (!limit) return "";
  return formatted("; the limit of the address space is %.4g GB (ulimit -v)",
                   static_cast<double>(*limit) / 1e9);
}

std::int64_t peak_memory_bytes(MPI_Comm comm) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return sum(comm, 1024 * static_cast<std::int64_t>(usage.ru_maxrss));
}

std::int64_t installed_memory_bytes(MPI_Comm comm) {
  std::int64_t bytes = static_cast<std::int64_t>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  if (const auto limit = memory_limit()) bytes = std::min(bytes, limit->limit);
  const std::int64_t built_in = sum_over_machines(comm, bytes);
  return std::min(built_in, sum_of_bounds(comm, address_space_limit()).value_or(built_in));
}

std::int64_t available_memory_bytes(MPI_Comm comm) {
  // Linux's own estimate also counts what caches would give back.
  std::int64_t kilobytes =
      static_cast<std::int64_t>(sysconf(_SC_AVPHYS_PAGES)) * sysconf(_SC_PAGESIZE) / 1024;
  std::ifstream file("/proc/meminfo");
  std::string name, value, unit;
  while (file >> name >> value && std::getline(file, unit))
    if (name == "MemAvailable:") kilobytes = number_in<std::int64_t>(value).value_or(kilobytes);
  std::int64_t bytes = 1024 * kilobytes;
  if (const auto limit = memory_limit()) bytes = std::min(bytes, limit->available);
  const std::int64_t free = sum_over_machines(comm, bytes);
  return std::min(free, sum_of_bounds(comm, address_space_left()).value_or(free));
}

void require_memory(MPI_Comm comm, double bytes, const std::string& what) {
  const auto installed = static_cast<double>(installed_memory_bytes(comm));
  if (bytes <= installed) return;
  throw InputError(
      what +
      formatted(" need at least %.4g GB of memory; allowed: at most the %.4g GB of the machines of this run",
                bytes / 1e9, installed / 1e9) +
      address_space_words());
}

}  // namespace fabseq
