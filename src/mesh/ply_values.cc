// SPDX-License-Identifier: MIT
#include "mesh/ply_values.h"

#include "fabseq/base/error.h"
#include "fabseq/base/formatted.h"
#include "fabseq/base/plain_numbers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

namespace fabseq {

namespace {

constexpr std::string_view blanks = " \t\r\n\v\f";

[[noreturn]] void refuse_end() { throw InputError("ends before its data do, needs an intact PLY file"); }

/// The number whose bytes begin `data`, which loses them; `reversed` if they are in the other order than
/// here.
template <class Number>
double take(std::string_view& data, bool reversed) {
  if (data.size() < sizeof(Number)) refuse_end();
  std::array<char, sizeof(Number)> bytes;
  std::copy_n(data.begin(), bytes.size(), bytes.begin());
  if (reversed) std::reverse(bytes.begin(), bytes.end());
  data.remove_prefix(bytes.size());
  return static_cast<double>(std::bit_cast<Number>(bytes));
}

}  // namespace

std::optional<PlyType> ply_type(std::string_view name) {
  using enum PlyType;
  constexpr std::pair<std::string_view, PlyType> names[] = {
      {"char", int8},   {"uchar", uint8},   {"short", int16},     {"ushort", uint16},
      {"int", int32},   {"uint", uint32},   {"float", float32},   {"double", float64},
      {"int8", int8},   {"uint8", uint8},   {"int16", int16},     {"uint16", uint16},
      {"int32", int32}, {"uint32", uint32}, {"float32", float32}, {"float64", float64}};
  for (const auto& [known, type] : names)
    if (known == name) return type;
  return std::nullopt;
}

std::optional<PlyForm> ply_form(std::string_view name) {
  if (name == "ascii") return PlyForm::text;
  if (name == "binary_little_endian") return PlyForm::little_endian;
  if (name == "binary_big_endian") return PlyForm::big_endian;
  return std::nullopt;
}

double PlyValues::next(PlyType type) {
  if (form_ == PlyForm::text) return next_in_text();
  const bool reversed = (form_ == PlyForm::little_endian) != (std::endian::native == std::endian::little);
  switch (type) {
    case PlyType::int8:
      return take<std::int8_t>(rest_, reversed);
    case PlyType::uint8:
      return take<std::uint8_t>(rest_, reversed);
    case PlyType::int16:
      return take<std::int16_t>(rest_, reversed);
    case PlyType::uint16:
      return take<std::uint16_t>(rest_, reversed);
    case PlyType::int32:
      return take<std::int32_t>(rest_, reversed);
    case PlyType::uint32:
      return take<std::uint32_t>(rest_, reversed);
    case PlyType::float32:
      return take<float>(rest_, reversed);
    case PlyType::float64:
      return take<double>(rest_, reversed);
  }
  return 0.0;  // there are no other types
}

std::size_t PlyValues::next_count(PlyType type) {
  const double count = next(type);
  if (!(count >= 0.0) || count != std::floor(count))
    throw InputError(formatted("has a list of %g entries, needs an intact PLY file", count));
  if (count > static_cast<double>(rest_.size())) refuse_end();  // an entry takes a byte or more
  return static_cast<std::size_t>(count);
}

double PlyValues::next_in_text() {
  const std::size_t begin = rest_.find_first_not_of(blanks);
  if (begin == std::string_view::npos) refuse_end();
  rest_.remove_prefix(begin);
  const std::string_view word = rest_.substr(0, rest_.find_first_of(blanks));
  rest_.remove_prefix(word.size());
  const std::optional<double> value = number_in<double>(word.substr(word.starts_with('+') ? 1 : 0));
  if (!value) throw InputError("has \"" + std::string(word.substr(0, 40)) + "\" where a number belongs");
  return *value;
}

}  // namespace fabseq
