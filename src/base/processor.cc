// SPDX-License-Identifier: MIT
#include "base/processor.h"

#include "fabseq/base/error.h"

#include <cstdlib>
#include <cstring>
#include <unistd.h>

namespace fabseq {

namespace {

/// The instructions that are missing, or null. Those that came with the ones asked for are not asked for.
const char* missing_instructions() {
#if defined(__x86_64__)
  __builtin_cpu_init();
#if defined(__AVX512F__)
  if (__builtin_cpu_supports("avx512f") == 0) return "AVX-512";
#endif
#if defined(__AVX2__)
  if (__builtin_cpu_supports("avx2") == 0 || __builtin_cpu_supports("fma") == 0) return "AVX2";
#elif defined(__AVX__)
  if (__builtin_cpu_supports("avx") == 0) return "AVX";
#endif
#endif
  return nullptr;
}

void write_all(const char* text) { (void)!::write(STDERR_FILENO, text, std::strlen(text)); }

/// Runs before all other constructors: 101 is the first priority that is free.
[[gnu::constructor(101)]] void require_processor_first() { require_processor(); }

}  // namespace

// Nothing of the standard library may be used yet, strings least of all.
void require_processor() {
  const char* missing = missing_instructions();
  if (missing == nullptr) return;
  const char* rank = std::getenv("OMPI_COMM_WORLD_RANK");
  if (rank == nullptr || std::strcmp(rank, "0") == 0) {
    write_all("fabseq: compiled for processors with ");
    write_all(missing);
    write_all(", which this one lacks; compile it here, or with -D FABSEQ_NATIVE=OFF\n");
  }
  ::_exit(static_cast<int>(ExitStatus::bad_input));
}

}  // namespace fabseq
