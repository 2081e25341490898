// SPDX-License-Identifier: MIT
#pragma once

#include "base/thread_set.h"

namespace fabseq {

struct CoreCount {
  int cores = 0;    ///< physical ones
  int threads = 0;  ///< hardware threads, of which a core has one or more
};

/// The cores that `threads` of this machine belong to, as hwloc sees them. Where it sees none, each thread
/// counts as a core. Not collective.
CoreCount count_cores(const ThreadSet& threads);

}  // namespace fabseq
