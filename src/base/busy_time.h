// SPDX-License-Identifier: MIT
#pragma once

#include "base/thread_set.h"

#include <optional>
#include <string>

namespace fabseq {

/// Share of their time, 0 to 1, that these threads were busy between two readings of /proc/stat; nothing if
/// the readings do not tell. What waits for a disk is idle; what the host of a virtual machine takes away
/// counts as busy. Not collective.
std::optional<double> busy_share_between(const std::string& before, const std::string& after,
                                         const ThreadSet& threads);

}  // namespace fabseq
