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
#include <sys/resource.h>
#include <unistd.h>

namespace fabseq {

namespace {

std::int64_t sum_over_machines(MPI_Comm comm, std::int64_t bytes) {
  const NodeRanks machine(comm);
  return sum(comm, machine.is_first() ? bytes : 0);
}

}  // namespace

std::int64_t peak_memory_bytes(MPI_Comm comm) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return sum(comm, 1024 * static_cast<std::int64_t>(usage.ru_maxrss));
}

std::int64_t installed_memory_bytes(MPI_Comm comm) {
  std::int64_t bytes = static_cast<std::int64_t>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  if (const auto limit = memory_limit()) bytes = std::min(bytes, limit->limit);
  return sum_over_machines(comm, bytes);
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
  return sum_over_machines(comm, bytes);
}

void require_memory(MPI_Comm comm, double bytes, const std::string& what) {
  const auto installed = static_cast<double>(installed_memory_bytes(comm));
  if (bytes <= installed) return;
  throw InputError(
      what +
      formatted(" need at least %.4g GB of memory; allowed: at most the %.4g GB of the machines of this run",
                bytes / 1e9, installed / 1e9));
}

}  // namespace fabseq
