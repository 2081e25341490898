// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/process_settings.h"

namespace fabseq {

/// Checks what a process with plastic flow needs, and that values by temperature fit together
/// (docs/formulation.md 16). `has_temperature`: whether there is a block `thermal`. Throws InputError naming
/// the key. Not collective.
void check_process(const MaterialSettings& material, const ProcessSettings& process, bool has_temperature,
                   int dimension);

}  // namespace fabseq
