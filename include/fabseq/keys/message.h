// SPDX-License-Identifier: MIT
/// \file
/// How messages about a config point at places and guess what was meant.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// The word that was probably meant: the one with the smallest edit distance; empty if none is near. `most`
/// is the largest distance that counts as near; by default it is a third of the word's length, at least 2.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words,
                         std::optional<std::size_t> most = {});
/// JSON pointer with the member or list index appended (RFC 6901).
std::string pointer_to(const std::string& pointer, const std::string& member);
std::string pointer_to(const std::string& pointer, std::size_t index);

}  // namespace fabseq
