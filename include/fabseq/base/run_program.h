// SPDX-License-Identifier: MIT
/// \file
/// Other programs, such as those of the tools that draw. Nothing here is collective or throws.
#pragma once

#include <string>
#include <vector>

namespace fabseq {

/// Runs a program, without a shell, and waits for its end: `words` are its path and its arguments. Returns ""
/// if it ended with status 0, or else why it did not: the last line of its standard error, if there is one.
/// It has no input and nothing else that it prints is kept. It does not get the variables by which an MPI
/// would take it for a rank of this run. It is ended after so many seconds, or when this process is asked to
/// stop (stop.h).
std::string run_program(const std::vector<std::string>& words, double most_seconds);

/// Path of fabseq-tools: beside this program, where both are installed; in `scripts` of the source tree in
/// whose build folder this program lies; or on PATH. Empty if it is nowhere.
std::string find_tools();

}  // namespace fabseq
