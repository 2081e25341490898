// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/process/process_settings.h"

namespace fabseq {

/// Checks that the material's values by temperature fit together. Throws InputError naming the key. Not
/// collective.
void check_curves(const MaterialSettings& material);

/// Checks what a process with plastic flow needs (docs/formulation.md 16). `has_temperature`: whether there
/// is a block `thermal`. Throws InputError naming the key. Not collective.
void check_process(const MaterialSettings& material, const ProcessSettings& process, bool has_temperature,
                   int dimension);

}  // namespace fabseq
