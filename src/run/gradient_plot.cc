// SPDX-License-Identifier: MIT
#include "fabseq/run/gradient_check.h"
#include "fabseq/run/svg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace fabseq {

namespace {

/// A frame with logarithmic axes, in pixels of the picture.
struct GradientFrame {
  double left = 80, right = 560, top = 50, bottom = 400;
  double first_step = -7, last_step = -1, lowest = -12, highest = 1;  ///< decades

  double x(double step) const {
    return left + (std::log10(step) - first_step) / (last_step - first_step) * (right - left);
  }
  double y(double error) const {
    const double decade = std::clamp(std::log10(std::max(error, 1e-300)), lowest, highest);
    return bottom - (decade - lowest) / (highest - lowest) * (bottom - top);
  }
};

constexpr std::array<const char*, 6> colors = {"#1b6ca8", "#d1495b", "#2e933c",
                                               "#8a5fbf", "#c77d0a", "#444444"};

void draw_axes(std::ostringstream& text, const GradientFrame& frame) {
  text << "<rect x='" << frame.left << "' y='" << frame.top << "' width='" << frame.right - frame.left
       << "' height='" << frame.bottom - frame.top << "' fill='none' stroke='#999'/>\n";
  for (int decade = static_cast<int>(frame.first_step); decade <= frame.last_step; ++decade)
    text << "<text x='" << frame.x(std::pow(10.0, decade)) << "' y='" << frame.bottom + 18
         << "' text-anchor='middle'>1e" << decade << "</text>\n";
  for (int decade = static_cast<int>(frame.lowest); decade <= frame.highest; decade += 2) {
    const double y = frame.y(std::pow(10.0, decade));
    text << "<text x='" << frame.left - 8 << "' y='" << y + 4 << "' text-anchor='end'>1e" << decade
         << "</text>\n";
    text << "<line x1='" << frame.left << "' x2='" << frame.right << "' y1='" << y << "' y2='" << y
         << "' stroke='#eee'/>\n";
  }
  text << "<text x='" << 0.5 * (frame.left + frame.right) << "' y='" << frame.bottom + 40
       << "' text-anchor='middle'>step, fraction of the variable's range</text>\n"
       << "<text transform='translate(22," << 0.5 * (frame.top + frame.bottom)
       << ") rotate(-90)' text-anchor='middle'>relative error of the directional derivative</text>\n";
}

}  // namespace

std::string GradientCheck::svg(const std::string& title) const {
  const GradientFrame frame;
  const double height = std::max(460.0, frame.top + 20.0 + 18.0 * static_cast<double>(errors.size()));
  std::ostringstream text;
  text << svg::begin(800, height) << "<text x='" << frame.left << "' y='30' font-size='16'>"
       << svg::escaped(title) << "</text>\n";
  draw_axes(text, frame);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const char* color = colors[i % colors.size()];
    const char* dashes = i / colors.size() % 2 == 0 ? "none" : "5,3";
    text << "<polyline fill='none' stroke='" << color << "' stroke-dasharray='" << dashes
         << "' stroke-width='1.5' points='";
    for (std::size_t s = 0; s < steps.size(); ++s)
      text << frame.x(steps[s]) << ',' << frame.y(errors[i].relative[s]) << ' ';
    const double y = frame.top + 12.0 + 18.0 * static_cast<double>(i);
    text << "'/>\n<line x1='580' x2='604' y1='" << y - 4 << "' y2='" << y - 4 << "' stroke='" << color
         << "' stroke-dasharray='" << dashes << "' stroke-width='2'/>\n<text x='610' y='" << y << "'>"
         << errors[i].name << " " << errors[i].type
         << (errors[i].variables == "design" ? "" : ", " + errors[i].variables) << "</text>\n";
  }
  text << "</svg>\n";
  return text.str();
}

}  // namespace fabseq
