// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace fabseq {

/// Why a file cannot be read: it is missing, may not be read, or is no regular file (a directory, a pipe, a
/// device), on which a read might never end. "" if it can be. Does not open pipes or devices. Not collective.
std::string reading_problem(const std::string& path);
/// Throws InputError, which names `pointer` and `allowed`, if a file cannot be read. Not collective.
void require_readable(const std::string& pointer, const std::string& path, const std::string& allowed);

}  // namespace fabseq
