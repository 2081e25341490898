// SPDX-License-Identifier: MIT
/// \file
/// Words and numbers of mesh files that are text.
#pragma once

#include "fabseq/grid/index_box.h"

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace fabseq {

/// The words of a text, one after the other. Refers to the text.
class TextWords {
 public:
  explicit TextWords(std::string_view text) : text_(text) {}

  /// The next word; empty at the end of the text.
  std::string_view next();
  void skip_line();
  /// The next word as a coordinate: with a decimal point or a comma. Throws InputError if it is none.
  double next_coordinate();
  Point<3> next_point();
  /// The line of the last word, from 1 on. Lines end with LF, CR or both.
  std::size_t line() const;

 private:
  std::string_view text_;
  std::size_t place_ = 0;
};

std::string lower_case(std::string_view text);
/// Leaves out the byte order mark that some programs write first.
std::string_view without_mark(std::string_view text);

/// Rounds coordinates to single precision, as far as the points lie no further from the origin than some
/// times their own extent; else their distances from the lower corner of all of them. Programs write a point
/// that several triangles share with different last digits.
void round_to_single(std::vector<Point<3>>& points);

}  // namespace fabseq
