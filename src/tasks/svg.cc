// SPDX-License-Identifier: MIT
#include "tasks/svg.h"

#include "fabseq/base/formatted.h"

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

std::string number(double value) { return formatted("%.2f", value); }

}  // namespace fabseq::svg
