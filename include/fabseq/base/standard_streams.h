// SPDX-License-Identifier: MIT
/// \file
/// Text for standard output and standard error that never keeps a run from stopping.
#pragma once

#include <string>

namespace fabseq {

/// Writes text to file descriptor 1 or 2, whole, and waits where there is no room for it. Once this rank has
/// been asked to stop (stop.h) it waits no longer than a moment, and what has no room is lost: mpirun, told
/// to end, reads no more of what its ranks print, and a checkpoint must not wait for that. Does not fail.
void write_text(int descriptor, const std::string& text) noexcept;

}  // namespace fabseq
