// SPDX-License-Identifier: MIT
#include "fabseq/base/formatted.h"
#include "tasks/gradient_check.h"
#include "tasks/svg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

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

std::string axes(const GradientFrame& frame) {
  std::string text = formatted("<rect x='%g' y='%g' width='%g' height='%g' fill='none' stroke='#999'/>\n",
                               frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top);
  for (int decade = static_cast<int>(frame.first_step); decade <= frame.last_step; ++decade)
    text += formatted("<text x='%g' y='%g' text-anchor='middle'>1e%d</text>\n",
                      frame.x(std::pow(10.0, decade)), frame.bottom + 18, decade);
  for (int decade = static_cast<int>(frame.lowest); decade <= frame.highest; decade += 2) {
    const double y = frame.y(std::pow(10.0, decade));
    text += formatted("<text x='%g' y='%g' text-anchor='end'>1e%d</text>\n", frame.left - 8, y + 4, decade);
    text +=
        formatted("<line x1='%g' x2='%g' y1='%g' y2='%g' stroke='#eee'/>\n", frame.left, frame.right, y, y);
  }
  text +=
      formatted("<text x='%g' y='%g' text-anchor='middle'>step, fraction of the variable's range</text>\n",
                0.5 * (frame.left + frame.right), frame.bottom + 40);
  return text + formatted(
                    "<text transform='translate(22,%g) rotate(-90)' text-anchor='middle'>relative error "
                    "of the directional derivative</text>\n",
                    0.5 * (frame.top + frame.bottom));
}

}  // namespace

std::string GradientCheck::svg(const std::string& title) const {
  const GradientFrame frame;
  const double height = std::max(460.0, frame.top + 20.0 + 18.0 * static_cast<double>(errors.size()));
  std::string text = svg::begin(800, height) + formatted("<text x='%g' y='30' font-size='16'>", frame.left) +
                     svg::escaped(title) + "</text>\n" + axes(frame);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const char* color = colors[i % colors.size()];
    const char* dashes = i / colors.size() % 2 == 0 ? "none" : "5,3";
    text += formatted("<polyline fill='none' stroke='%s' stroke-dasharray='%s' stroke-width='1.5' points='",
                      color, dashes);
    for (std::size_t s = 0; s < steps.size(); ++s)
      text += formatted("%g,%g ", frame.x(steps[s]), frame.y(errors[i].relative[s]));
    const double y = frame.top + 12.0 + 18.0 * static_cast<double>(i);
    text += formatted(
        "'/>\n<line x1='580' x2='604' y1='%g' y2='%g' stroke='%s' stroke-dasharray='%s' "
        "stroke-width='2'/>\n<text x='610' y='%g'>",
        y - 4, y - 4, color, dashes, y);
    text += errors[i].name + " " + errors[i].type +
            (errors[i].variables == "design" ? "" : ", " + errors[i].variables) + "</text>\n";
  }
  return text + "</svg>\n";
}

}  // namespace fabseq
