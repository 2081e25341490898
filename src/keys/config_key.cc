// SPDX-License-Identifier: MIT
#include "fabseq/keys/config_key.h"

#include "fabseq/base/formatted.h"
#include "fabseq/base/plain_numbers.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// "-inf" and "inf" are numbers, too.
double parse_bound(std::string_view text) { return number_in<double>(text).value(); }

std::string number_text(double value) { return formatted("%g", value); }

std::string entries(int dimension) {
  return dimension == 0 ? std::string("2 or 3") : std::to_string(dimension);
}

std::string axis_names(int dimension) { return dimension == 2 ? "x, y" : "x, y, z"; }

/// The values that the key takes besides its words.
std::string plain_values(const ConfigKey& key, int dimension) {
  const std::string range = Interval::parse(key.range).text();
  switch (key.type) {
    case KeyType::flag:
      return "true or false";
    case KeyType::integer:
      return "an integer" + range;
    case KeyType::number:
      return "a number" + range;
    case KeyType::text:
      return "a text";
    case KeyType::path:
      return "a file name";
    case KeyType::choice:
      return join(split(key.words, ' '), ", ");
    case KeyType::axis:
      return axis_names(dimension);
    case KeyType::face:
      return dimension == 2 ? "x-, x+, y-, y+" : "x-, x+, y-, y+, z-, z+";
    case KeyType::vector:
      return "a list of " + entries(dimension) + " numbers" + range;
    case KeyType::integer_vector:
      return "a list of " + entries(dimension) + " integers" + range;
    case KeyType::bounds:
      return "a list of two ascending numbers" + range;
    case KeyType::strain:
      return std::string(dimension == 0   ? "a list of 3 (xx, yy, xy) or 6 numbers (xx, yy, zz, xy, yz, zx)"
                         : dimension == 2 ? "a list of 3 numbers (xx, yy, xy)"
                                          : "a list of 6 numbers (xx, yy, zz, xy, yz, zx)") +
             " or {\"tangential\": number, \"normal\": number}";
    case KeyType::vectors:
      return "a list of lists of " + entries(dimension) + " numbers" + range;
    case KeyType::lengths:
      return "a number" + range + ", or a list of " + entries(dimension) + " such numbers";
    case KeyType::turns:
      return "a list of [axis, degrees], where axis is \"x\", \"y\", \"z\" or a vector other than 0";
    case KeyType::points:
      return "a list of three or more pairs of numbers";
    case KeyType::profile:
      return "a list of two or more pairs [height, radius >= 0], heights ascending, or an empty list";
    case KeyType::list:
      return "a list of numbers" + range;
    case KeyType::angles:
      return std::string("a list of lists of ") + (dimension == 0   ? "1 (2D) or 2 (3D) numbers"
                                                   : dimension == 2 ? "1 number"
                                                                    : "2 numbers");
    case KeyType::angle_bounds:
      return "a list of two ascending numbers, or a list of such lists";
    case KeyType::word_list:
      return "a list of some of " + join(split(key.words, ' '), ", ");
    case KeyType::starts:
      return "a list of values of sequence.initial";
    case KeyType::shapes:
      return "a list of one or more shapes";
    case KeyType::sections:
      return "a list of objects";
    case KeyType::shape:
      return "an object with one shape";
    case KeyType::section:
    case KeyType::part:
    case KeyType::node_sets:
      return "an object";
    case KeyType::of_member:
      return "nothing";
  }
  return "";
}

}  // namespace

Interval Interval::parse(std::string_view text) {
  if (text.empty()) text = "(-inf, inf)";
  const std::size_t comma = text.find(", ");
  return {parse_bound(text.substr(1, comma - 1)),
          parse_bound(text.substr(comma + 2, text.size() - comma - 3)), text.front() == '(',
          text.back() == ')'};
}

bool Interval::contains(double value) const {
  return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Interval::text() const {
  if (std::isinf(low) && std::isinf(high)) return "";
  if (std::isinf(high)) return (low_open ? " > " : " >= ") + number_text(low);
  return std::string(" in ") + (low_open ? "(" : "[") + number_text(low) + ", " + number_text(high) +
         (high_open ? ")" : "]");
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> result;
  if (text.empty()) return result;
  std::size_t start = 0;
  for (std::size_t end = text.find(separator); end != std::string_view::npos;
       end = text.find(separator, start)) {
    result.emplace_back(text.substr(start, end - start));
    start = end + 1;
  }
  result.emplace_back(text.substr(start));
  return result;
}

std::string subsection(const ConfigKey& key) {
  return key.section.empty() ? key.name : key.section + "." + key.name;
}

std::string flat_option_value(const ConfigKey& key, const std::string& text) {
  const std::vector<std::string> words = split(key.words, ' ');
  if (std::find(words.begin(), words.end(), text) != words.end()) return to_text(text);
  switch (key.type) {
    case KeyType::vector:
    case KeyType::integer_vector:
    case KeyType::bounds:
    case KeyType::strain:
      return text.rfind('[', 0) == 0 ? text : "[" + text + "]";
    case KeyType::lengths:
      return text.find(',') == std::string::npos || text.rfind('[', 0) == 0 ? text : "[" + text + "]";
    case KeyType::text:
    case KeyType::path:
      return to_text(text);
    default:
      return text;
  }
}

std::string allowed_values(const ConfigKey& key, int dimension) {
  std::string plain = plain_values(key, dimension);
  if (key.words.empty() || key.type == KeyType::choice || key.type == KeyType::word_list) return plain;
  std::string words;
  for (const std::string& word : split(key.words, ' ')) words += to_text(word) + " or ";
  return words + plain;
}

}  // namespace fabseq
