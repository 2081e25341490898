// SPDX-License-Identifier: MIT
#include "base/thread_set.h"

#include <bit>
#include <sched.h>
#include <unistd.h>

namespace fabseq {

bool ThreadSet::has(int thread) const {
  return thread >= 0 && thread < most && ((words_[thread / bits] >> (thread % bits)) & 1UL) != 0;
}

void ThreadSet::add(int thread) {
  if (thread >= 0 && thread < most) words_[thread / bits] |= 1UL << (thread % bits);
}

int ThreadSet::count() const {
  int result = 0;
  for (const unsigned long word : words_) result += std::popcount(word);
  return result;
}

void ThreadSet::unite(MPI_Comm comm) {
  MPI_Allreduce(MPI_IN_PLACE, words_.data(), static_cast<int>(words_.size()), MPI_UNSIGNED_LONG, MPI_BOR,
                comm);
}

ThreadSet threads_of_process() {
  ThreadSet result;
  cpu_set_t allowed[ThreadSet::most / CPU_SETSIZE];  // a single one ends at 1024
  CPU_ZERO_S(sizeof allowed, allowed);
  if (::sched_getaffinity(0, sizeof allowed, allowed) == 0)
    for (int thread = 0; thread < ThreadSet::most; ++thread)
      if (CPU_ISSET_S(thread, sizeof allowed, allowed)) result.add(thread);
  if (result.count() > 0) return result;
  const auto online = static_cast<int>(::sysconf(_SC_NPROCESSORS_ONLN));
  for (int thread = 0; thread < online; ++thread) result.add(thread);
  return result;
}

}  // namespace fabseq
