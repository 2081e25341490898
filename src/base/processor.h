// SPDX-License-Identifier: MIT
/// \file
/// Whether the processor has the instructions that the program was compiled to.
#pragma once

namespace fabseq {

/// Ends the program with one line and status 2 if it has not. The first such instruction would end it with
/// SIGILL, which says nothing. Runs by itself, before what C++ sets up; whoever calls it makes sure that it
/// is linked.
void require_processor();

}  // namespace fabseq
