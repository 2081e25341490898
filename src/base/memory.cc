#include "fabseq/base/memory.h"

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"

#include <cstdio>
#include <sys/resource.h>
#include <unistd.h>

namespace fabseq {

std::int64_t peak_memory_bytes(MPI_Comm comm) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return sum(comm, 1024 * static_cast<std::int64_t>(usage.ru_maxrss));
}

std::int64_t installed_memory_bytes(MPI_Comm comm) {
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  const bool counts = rank_of(machine) == 0;
  MPI_Comm_free(&machine);
  const std::int64_t bytes = static_cast<std::int64_t>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  return sum(comm, counts ? bytes : 0);
}

void require_memory(MPI_Comm comm, double bytes, const std::string& what) {
  const auto installed = static_cast<double>(installed_memory_bytes(comm));
  if (bytes <= installed) return;
  char amounts[160];
  std::snprintf(amounts, sizeof amounts,
                " need at least %.4g GB of memory; allowed: at most the %.4g GB of the machines of this run",
                bytes / 1e9, installed / 1e9);
  throw InputError(what + amounts);
}

}  // namespace fabseq
