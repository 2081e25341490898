// SPDX-License-Identifier: MIT
#include "mesh/text_values.h"

#include "fabseq/base/error.h"
#include "fabseq/base/plain_numbers.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace fabseq {

namespace {

constexpr std::string_view between_words = " \t\r\n\v\f", line_ends = "\r\n";

/// The number that a whole word is. What is too small for a double is 0.
std::optional<double> coordinate_in(std::string_view word) {
  if (word.ends_with(',')) word.remove_suffix(1);
  if (word.starts_with('+')) word.remove_prefix(1);
  if (const std::optional<double> value = number_in<double>(word)) return value;
  std::string text(word);
  const std::size_t comma = text.find(',');
  if (comma != std::string::npos && text.find('.') == std::string::npos) text[comma] = '.';
  if (const std::optional<double> value = number_in<double>(text)) return value;
  double value = 0.0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool tiny = read.ec == std::errc::result_out_of_range && read.ptr == text.data() + text.size() &&
                    lower_case(text).find("e-") != std::string::npos;
  return tiny ? std::optional(0.0) : std::nullopt;
}

}  // namespace

std::string_view TextWords::next() {
  place_ = std::min(text_.find_first_not_of(between_words, place_), text_.size());
  const std::size_t begin = place_;
  place_ = std::min(text_.find_first_of(between_words, place_), text_.size());
  return text_.substr(begin, place_ - begin);
}

void TextWords::skip_line() { place_ = std::min(text_.find_first_of(line_ends, place_), text_.size()); }

double TextWords::next_coordinate() {
  const std::string_view word = next();
  if (const std::optional<double> value = coordinate_in(word)) return *value;
  throw InputError("has \"" + std::string(word.substr(0, 40)) + "\" in line " + std::to_string(line()) +
                   ", needs a coordinate");
}

Point<3> TextWords::next_point() {
  Point<3> point;
  for (double& coordinate : point) coordinate = next_coordinate();
  return point;
}

std::size_t TextWords::line() const {
  const std::string_view before = text_.substr(0, place_);
  std::size_t count = 1;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i] == '\n' || (before[i] == '\r' && !before.substr(i + 1).starts_with('\n'))) ++count;
  return count;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::string_view without_mark(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

void round_to_single(std::vector<Point<3>>& points) {
  constexpr double far = 64.0;
  if (points.empty()) return;
  Point<3> low = points.front(), high = low;
  for (const Point<3>& point : points)
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], point[axis]);
      high[axis] = std::max(high[axis], point[axis]);
    }
  double extent = 0.0, farthest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    extent = std::max(extent, high[axis] - low[axis]);
    farthest = std::max({farthest, std::abs(low[axis]), std::abs(high[axis])});
  }
  const Point<3> from = farthest > far * extent ? low : Point<3>{};
  // Axis by axis: with the axes inside, g++ 12 leaves the last points as they are (-O3, AVX-512).
  for (int axis = 0; axis < 3; ++axis)
    for (Point<3>& point : points)
      point[axis] = from[axis] + static_cast<double>(static_cast<float>(point[axis] - from[axis]));
}

}  // namespace fabseq
