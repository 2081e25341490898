// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace fabseq {

/// Types of numbers in PLY files.
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
/// The type of that name, such as "uchar" or "float32"; none if there is no such type.
std::optional<PlyType> ply_type(std::string_view name);

/// How a PLY file writes numbers.
enum class PlyForm { text, little_endian, big_endian };
/// The form that a header calls so, such as "ascii"; none if there is no such form.
std::optional<PlyForm> ply_form(std::string_view name);

/// The numbers of a PLY file behind its header, one after the other. Errors are InputError. Refers to the
/// data.
class PlyValues {
 public:
  PlyValues(std::string_view data, PlyForm form) : rest_(data), form_(form) {}

  /// The next number. Throws InputError if there is none.
  double next(PlyType type);
  /// The next number as the length of a list. Throws InputError if it is none, or more than the file has
  /// left.
  std::size_t next_count(PlyType type);

 private:
  double next_in_text();

  std::string_view rest_;
  PlyForm form_;
};

}  // namespace fabseq
