// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/chain/design.h"
#include "fabseq/config/command_line.h"
#include "fabseq/config/setup.h"
#include "fabseq/sequence/sequence.h"

#include <string>

namespace fabseq {

/// A design that a run begins with in place of that of its command line, by which nothing is scaled.
struct FirstDesign {
  Design design;     ///< as the run's setup shares it out
  std::string file;  ///< that keeps it, too; for messages
};

/// The design to start from: that of -design FILE, or the initial values, with a warning where the file has
/// none. Throws InputError if it does not fit the part or leaves the bounds.
template <int Dim>
Design starting_design(const Setup<Dim>& setup, const Sequence<Dim>& sequence,
                       const CommandLine& command_line);
/// Throws the same InputError if a design leaves the bounds. Collective.
template <int Dim>
void require_within_bounds(const Setup<Dim>& setup, const Sequence<Dim>& sequence, const FirstDesign& given);

}  // namespace fabseq
