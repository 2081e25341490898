// SPDX-License-Identifier: MIT
/// \file
/// Lets one allocation fail: a library to be preloaded (LD_PRELOAD) under every rank of a run.
///
///     FAILING_RANK     the rank whose `new` throws std::bad_alloc
///     FAILING_NUMBER   which of its calls for 4096 bytes or more, from 1; 0 for none. Destructors of JSON
///     values
///                      allocate, too, and no exception may leave them: but for less
///     FAILING_REPORT   a folder; the rank writes the number of its calls to the file RANK there when it ends
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

constexpr std::size_t least_size = 4096;
std::atomic<long> calls = 0;

bool is_chosen() {
  const char *rank = std::getenv("OMPI_COMM_WORLD_RANK"), *chosen = std::getenv("FAILING_RANK");
  return rank && chosen && std::strcmp(rank, chosen) == 0;
}

long number() {
  const char* text = std::getenv("FAILING_NUMBER");
  return text ? std::atol(text) : 0;
}

struct Report {
  ~Report() {
    const char *folder = std::getenv("FAILING_REPORT"), *rank = std::getenv("OMPI_COMM_WORLD_RANK");
    if (!folder || !is_chosen()) return;
    char path[4096];
    std::snprintf(path, sizeof path, "%s/%s", folder, rank);
    if (std::FILE* file = std::fopen(path, "w")) {
      std::fprintf(file, "%ld\n", calls.load());
      std::fclose(file);
    }
  }
} report;

}  // namespace

void* operator new(std::size_t size) {
  static const bool chosen = is_chosen();
  static const long fails = number();
  if (chosen && size >= least_size && ++calls == fails) throw std::bad_alloc();
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
