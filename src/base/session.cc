// SPDX-License-Identifier: MIT
#include "fabseq/base/session.h"

#include "base/launch.h"
#include "base/processor.h"
#include "fabseq/base/blas.h"
#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/memory.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/one_line.h"
#include "fabseq/base/petsc.h"
#include "fabseq/base/plain_numbers.h"
#include "fabseq/base/stop.h"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <malloc.h>
#include <new>
#include <poll.h>
#include <string_view>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace fabseq {

namespace {

/// Keeps PETSc from printing a trace; check() puts the message into the exception instead.
PetscErrorCode quiet_error_handler(MPI_Comm, int, const char*, const char*, PetscErrorCode code,
                                   PetscErrorType, const char*, void*) {
  return code;
}

/// Libraries end or hang where they find no room: MPI_Init takes some 0.2 GB, OpenBLAS 0.13 GB, the smallest
/// run 0.1 GB.
void require_address_space(bool with_mpi) {
  const std::int64_t needed = with_mpi ? 450'000'000 : 250'000'000;
  const auto left = address_space_left();
  if (!left || *left >= needed) return;
  const std::int64_t limit = *address_space_limit();
  throw InputError(
      formatted("the limit of the address space: found %.3g GB (ulimit -v); allowed: %.3g GB for the "
                "smallest part, or unlimited",
                static_cast<double>(limit) / 1e9, static_cast<double>(limit - *left + needed) / 1e9));
}

/// OpenBLAS takes its buffer at the first call that needs one, and tries for ever if there is no room. Where
/// there is a limit it gets it at once.
void take_room_for_blas() {
  if (!address_space_limit()) return;
  const int one = 1;
  double matrix = 1.0;
  int info = 0;
  dpotrf_("L", &one, &matrix, &one, &info);
}

/// Tells, before MPI_Init, whether this process is the first of those that were started together.
bool is_first_by_launcher() {
  for (const char* rank : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"})
    if (const char* number = std::getenv(rank)) return std::string_view(number) == "0";
  return true;
}

/// An allocation that the limit of the address space has kept from this rank: a refusal, as of a part that is
/// too large for the machines. Without such a limit it is an exception like others. Other ranks may wait for
/// this one.
int out_of_address_space() {
  const auto status = static_cast<int>(ExitStatus::bad_input);
  const bool alone = size_of(PETSC_COMM_WORLD) == 1;
  const std::string rank = alone ? "" : "rank " + std::to_string(rank_of(PETSC_COMM_WORLD)) + ": ";
  write_text(STDERR_FILENO, "fabseq: " + rank + "no memory is left" + address_space_words() + "\n");
  if (!alone) MPI_Abort(MPI_COMM_WORLD, status);
  (void)PetscOptionsSetValue(nullptr, "-options_left", "no");
  return status;
}

/// Launchers end all other processes once one has ended with an error: others wait so long for the first one.
constexpr std::chrono::milliseconds first_to_speak{500};

/// Says in one line what PetscInitialize does not like of its options, and returns the exit status. Ranks
/// that wait for this one in there are ended by mpirun.
int refused(const Error& error) {
  int initialized = 0;
  MPI_Initialized(&initialized);
  if (initialized == 0 ? is_first_by_launcher() : rank_of(MPI_COMM_WORLD) == 0)
    write_text(STDERR_FILENO, "fabseq: " + one_line(error.what()) + "\n");
  else if (initialized == 0)
    std::this_thread::sleep_for(first_to_speak);
  return static_cast<int>(error.status());
}

/// PETSc options that were never read are most likely misspelt. With -options_left, PETSc lists them itself.
void warn_about_unread_options() {
  PetscBool listed = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, "-options_left", &listed));
  if (listed) return;
  PetscInt count = 0;
  char** names = nullptr;
  char** values = nullptr;
  check(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  for (PetscInt i = 0; i < count; ++i) warn(std::string("option -") + names[i] + " was not read by anybody");
  check(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  check(PetscOptionsSetValue(nullptr, "-options_left", "no"));
}

int guarded(const std::function<void()>& program) {
  try {
    program();
    warn_about_unread_options();
    return static_cast<int>(ExitStatus::done);
  } catch (const Error& error) {
    if (rank_of(PETSC_COMM_WORLD) == 0) write_text(STDERR_FILENO, "fabseq: " + one_line(error.what()) + "\n");
    (void)PetscOptionsSetValue(nullptr, "-options_left", "no");
    return static_cast<int>(error.status());
  } catch (const std::exception& error) {
    if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr && address_space_limit())
      return out_of_address_space();
    std::fprintf(stderr, "fabseq: rank %d: %s\n", rank_of(PETSC_COMM_WORLD), error.what());
    std::fflush(stderr);
    MPI_Abort(MPI_COMM_WORLD, static_cast<int>(ExitStatus::numerical_failure));
    return static_cast<int>(ExitStatus::numerical_failure);
  }
}

/// Prefers ROMIO among Open MPI's two ways of parallel file access. Its ranks agree on whether a file is
/// open; with the other, a rank that cannot open the file leaves the others waiting. The call has no effect
/// where there is only one way, or with another MPI.
void prefer_romio() {
  for (const char* parameter : {"OMPI_MCA_io_romio321_priority", "OMPI_MCA_io_romio341_priority"})
    (void)::setenv(parameter, "60", 0);  // the other one has 30; what the user has set stays
}

/// Fixes the size from which on the C library takes blocks from the system and gives them back. By default
/// this threshold grows up to 32 MB as blocks are freed. Fields of that size then stay in pieces of the heap:
/// 0.4 GB of 3 GB within ten iterations.
void give_memory_back() {
#ifdef __GLIBC__
  (void)::mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
}

constexpr int moment = 100;  // milliseconds

/// A second descriptor of the same pipe or terminal, on which writes do not wait. The original is shared with
/// other writers and keeps its mode. The descriptor is -1 if there is none, or if writes never have to wait.
class WithoutWaiting {
 public:
  explicit WithoutWaiting(int descriptor) {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || !(S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode))) return;
    char path[40];
    (void)std::snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
    descriptor_ = ::open(path, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  }
  WithoutWaiting(WithoutWaiting&&) = delete;
  ~WithoutWaiting() {
    if (descriptor_ >= 0) (void)::close(descriptor_);
  }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
};

/// Whether there may be room now; false if waiting any longer is not worth it.
bool wait_for_room(int descriptor) {
  const bool stops = stop_requested();
  pollfd waiting{descriptor, POLLOUT, 0};
  const int ready = ::poll(&waiting, 1, moment);
  return ready > 0 || !stops;
}

}  // namespace

Session::Session(const std::vector<std::string>& petsc_arguments) {
  require_processor();
  PetscBool running = PETSC_FALSE;
  (void)PetscInitialized(&running);
  begun_ = running == PETSC_FALSE;
  require_address_space(begun_);
  if (begun_) {
    std::vector<std::string> copies = petsc_arguments;
    // fabseq handles signals itself (stop.h), and a closed pipe, as of `| head`, must not end in a trace.
    copies.emplace_back("-no_signal_handler");
    std::vector<char*> pointers;
    pointers.reserve(copies.size() + 1);
    for (std::string& argument : copies) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    int count = static_cast<int>(copies.size());
    char** arguments = pointers.data();
    prefer_romio();
    leave_step_of_shell();
    give_memory_back();
    PetscErrorPrintf = PetscErrorPrintfNone;  // there can be no error handler yet
    check_options(PetscInitialize(&count, &arguments, nullptr, nullptr));
    PetscErrorPrintf = PetscErrorPrintfDefault;
  }
  take_room_for_blas();
  (void)PetscPushErrorHandler(quiet_error_handler, nullptr);
}

Session::~Session() {
  (void)PetscPopErrorHandler();
  if (begun_) (void)PetscFinalize();
}

int run_session(const std::vector<std::string>& petsc_arguments, const std::function<void()>& program) {
  const PlainNumbers plain;  // PETSc's options and what it prints follow the locale
  try {
    const Session session(petsc_arguments);
    return is_one_of_copies() ? static_cast<int>(ExitStatus::bad_input) : guarded(program);
  } catch (const Error& error) {
    return refused(error);
  }
}

void warn(const std::string& message) { warn(PETSC_COMM_WORLD, message); }

void warn(MPI_Comm comm, const std::string& message) {
  if (rank_of(comm) == 0) write_text(STDERR_FILENO, "warning: " + one_line(message) + "\n");
}

void print(const std::string& line) {
  if (rank_of(PETSC_COMM_WORLD) == 0) write_text(STDOUT_FILENO, line + "\n");
}

void write_text(int descriptor, const std::string& text) noexcept {
  (void)std::fflush(descriptor == STDERR_FILENO ? stderr : stdout);
  const WithoutWaiting other(descriptor);
  const int target = other.descriptor() >= 0 ? other.descriptor() : descriptor;
  std::string_view rest = text;
  while (!rest.empty()) {
    const ssize_t written = ::write(target, rest.data(), rest.size());
    if (written > 0) rest.remove_prefix(static_cast<std::size_t>(written));
    if (written >= 0 || errno == EINTR) continue;
    if (errno != EAGAIN || !wait_for_room(target)) return;
  }
}

}  // namespace fabseq
