// SPDX-License-Identifier: MIT
/// \file
/// How messages about a config point at places, and guess what was meant.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// The word that was probably meant (smallest edit distance), empty where none is near: `most` letters away
/// at most, by default a third of the word's.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words,
                         std::optional<std::size_t> most = {});
/// Pointer with the member or list index appended (RFC 6901).
std::string pointer_to(const std::string& pointer, const std::string& member);
std::string pointer_to(const std::string& pointer, std::size_t index);

}  // namespace fabseq
