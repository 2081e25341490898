// SPDX-License-Identifier: MIT
#include "fabseq/run/svg.h"

#include <array>
#include <cstdio>

namespace fabseq::svg {

std::string begin(double width, double height) {
  return "<svg xmlns='http://www.w3.org/2000/svg' width='" + number(width) + "' height='" + number(height) +
         "' font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' fill='white'/>\n";
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char character : text)
    result += character == '&' ? "&amp;" : character == '<' ? "&lt;" : std::string(1, character);
  return result;
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f", value);
  return text.data();
}

}  // namespace fabseq::svg
