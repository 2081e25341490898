// SPDX-License-Identifier: MIT
/// \file
/// Numbers as text with a decimal point, whatever the locale. A program that links the library sets any
/// locale at any time; no config, file or message may depend on that. Here are the ways to read numbers, and
/// to have other libraries read and write them; formatted.h writes them. Streams and std::to_string() of
/// floating point numbers follow the locale: neither is used for numbers.
#pragma once

#include <charconv>
#include <clocale>
#include <optional>
#include <string_view>
#include <system_error>

namespace fabseq {

/// The number that a whole text is, as std::from_chars() reads it; none if the text is no number of this
/// type.
template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const std::from_chars_result read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return value;
}

/// Lifetime over which the C library's functions, such as strtod() and printf(), read and write numbers with
/// a decimal point in this thread. Other threads, the process's locale, and what locales decide beside
/// numbers stay as they are. C++ streams are not affected.
class PlainNumbers {
 public:
  /// Throws std::bad_alloc if there is no memory for it.
  PlainNumbers();
  PlainNumbers(PlainNumbers&&) = delete;
  ~PlainNumbers();

 private:
  locale_t plain_;
  locale_t previous_;
};

}  // namespace fabseq
