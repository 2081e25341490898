// SPDX-License-Identifier: MIT
/// \file
/// Relations between keys of different sections.
#pragma once

#include "fabseq/config/command_line.h"
#include "fabseq/config/config.h"

namespace fabseq {

/// Checks relations between keys of a config whose single values are valid. Throws InputError. The same on
/// all ranks.
void check_rules(const Config& config);

/// What a task needs beyond a valid config. Throws InputError. The same on all ranks.
void check_task(const Config& config, Task task);

}  // namespace fabseq
