// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/machine/machine_entries.h"

namespace fabseq {

/// Adds to a config what follows from its machine, in the config's unit of length: keys that stand there
/// stay. Values of the wrong type are left for those who check the config. Throws InputError if that unit is
/// not known, or if layers are as thick as no whole number of the machine's beads. Not collective.
void add_machine_defaults(const MachineEntries& machine, Json& document);

}  // namespace fabseq
