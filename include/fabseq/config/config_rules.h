// SPDX-License-Identifier: MIT
/// \file
/// Relations between keys of different sections. Nothing here is collective; the outcome is the same on all
/// ranks.
#pragma once

#include "fabseq/config/command_line.h"
#include "fabseq/config/config.h"

namespace fabseq {

/// Checks relations between the keys of a config whose single values are valid. Throws InputError.
void check_rules(const Config& config);

/// Checks what a task needs beyond a valid config. Throws InputError.
void check_task(const Config& config, Task task);

}  // namespace fabseq
