// SPDX-License-Identifier: MIT
#include "base/launch.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"

#include <charconv>
#include <cstdlib>
#include <string>
#include <string_view>
#include <unistd.h>

namespace fabseq {

namespace {

/// A whole number in the environment; `otherwise` if there is none.
int number_of(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  if (text == nullptr) return otherwise;
  int value = otherwise;
  const std::string_view digits = text;
  (void)std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

/// Where a launcher says how many processes it has started, and which of them this one is.
struct Launcher {
  const char *count, *rank, *name, *instead;
};
constexpr Launcher launchers[] = {
    {"SLURM_STEP_NUM_TASKS", "SLURM_PROCID", "srun", "srun --mpi=pmix, or mpirun within the job"},
    {"PMI_SIZE", "PMI_RANK", "another MPI's mpirun or mpiexec", "the mpirun of Open MPI"},
    {"PALS_NRANKS", "PALS_RANKID", "another MPI's mpiexec", "the mpirun of Open MPI"}};

}  // namespace

bool is_one_of_copies() {
  if (size_of(MPI_COMM_WORLD) > 1 || std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) return false;
  for (const Launcher& launcher : launchers) {
    const int count = number_of(launcher.count, 1);
    if (count <= 1) continue;
    if (number_of(launcher.rank, 0) == 0)
      write_text(STDERR_FILENO,
                 std::string("fabseq: ") + launcher.name + " started " + std::to_string(count) +
                     " processes that do not know of each other; allowed: " + launcher.instead + "\n");
    return true;
  }
  return false;
}

}  // namespace fabseq
