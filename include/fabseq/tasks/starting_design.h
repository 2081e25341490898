// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/chain/design.h"
#include "fabseq/config/command_line.h"
#include "fabseq/config/setup.h"
#include "fabseq/sequence/sequence.h"

namespace fabseq {

/// The design to start from: that of -design FILE, or the initial values, with a warning where the file has
/// none. Throws InputError if it does not fit the part or leaves the bounds.
template <int Dim>
Design starting_design(const Setup<Dim>& setup, const Sequence<Dim>& sequence,
                       const CommandLine& command_line);

}  // namespace fabseq
