// SPDX-License-Identifier: MIT
#include "base/launch.h"

#include "fabseq/base/mpi.h"
#include "fabseq/base/posix_file.h"
#include "fabseq/base/session.h"

#include <charconv>
#include <cstdlib>
#include <fcntl.h>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

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

/// Whether Slurm's task with the terminal (`srun --pty`), the first, has started this process: it has no
/// other that could belong to the same run.
bool is_child_of_terminal_task() {
  if (std::getenv("SLURM_PTY_PORT") == nullptr || number_of("SLURM_PROCID", 0) != 0) return false;
  const std::string parent = read_file_if_there("/proc/" + std::to_string(::getppid()) + "/comm");
  return parent.rfind("slurmstepd", 0) != 0;  // otherwise it is the task itself
}

/// Whether this process is a command of an interactive shell: with a terminal, and not in the group of its
/// session's leader. Slurm starts tasks without a terminal or, with --pty, as the leader.
bool is_typed_into_a_shell() {
  const int terminal = ::open("/dev/tty", O_RDONLY | O_NOCTTY | O_CLOEXEC);
  if (terminal < 0) return false;
  (void)::close(terminal);
  return ::getpgrp() != ::getsid(0);
}

}  // namespace

void leave_step_of_shell() {
  if (std::getenv("SLURM_STEP_ID") == nullptr && std::getenv("SLURM_STEP_NUM_TASKS") == nullptr) return;
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) return;  // mpirun's
  if (!is_child_of_terminal_task() && !is_typed_into_a_shell()) return;
  std::vector<std::string> names = {"SLURM_STEP_ID", "SLURM_STEPID", "SLURM_STEP_NUM_TASKS"};
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view variable = *entry;
    if (variable.starts_with("PMI_") || variable.starts_with("PMIX_"))
      names.emplace_back(variable.substr(0, variable.find('=')));
  }
  for (const std::string& name : names) (void)::unsetenv(name.c_str());
}

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
