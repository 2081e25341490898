// SPDX-License-Identifier: MIT
#include "fabseq/base/formatted.h"
#include "tasks/sensitivity.h"
#include "tasks/svg.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace fabseq {

namespace {

struct Kind {
  SensitivityTable::Ratio ratio;
  const char* color;
  const char* meaning;
};
constexpr Kind kinds[] = {{&SensitivityRow::length_ratio, "#d1495b", "length of the first distortion term"},
                          {&SensitivityRow::rms_ratio, "#1b6ca8", "rms displacement of the part"}};

/// A line of 18 pixels per change, and a logarithmic axis of ratios over whole decades.
struct SensitivityFrame {
  double left = 300, right = 700, top = 70, row = 18, bottom = 0;
  double lowest = 0, highest = 1;  ///< decades

  explicit SensitivityFrame(const SensitivityTable& table)
      : bottom(top + row * static_cast<double>(table.rows.size())) {
    for (const SensitivityRow& of : table.rows)
      for (const Kind& kind : kinds)
        if (const auto ratio = (of.*kind.ratio)(); ratio && *ratio > 0.0) {
          lowest = std::min(lowest, std::floor(std::log10(*ratio)));
          highest = std::max(highest, std::ceil(std::log10(*ratio)));
        }
  }
  double x(double ratio) const {
    return left + (std::log10(ratio) - lowest) / (highest - lowest) * (right - left);
  }
  double y(std::size_t number) const { return top + row * (static_cast<double>(number) + 0.5); }
};

/// Decades, and where there are few of them, their halves and doubles.
std::vector<double> ticks(const SensitivityFrame& frame) {
  std::vector<double> result;
  for (double decade = frame.lowest; decade <= frame.highest; ++decade)
    for (const double digit : {1.0, 2.0, 5.0})
      if (digit == 1.0 || (decade < frame.highest && frame.highest - frame.lowest < 3.0))
        result.push_back(digit * std::pow(10.0, decade));
  return result;
}

std::string axis(const SensitivityFrame& frame) {
  std::string text = formatted("<rect x='%g' y='%g' width='%g' height='%g' fill='none' stroke='#999'/>\n",
                               frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top);
  for (const double ratio : ticks(frame)) {
    const double x = frame.x(ratio);
    text += formatted("<line x1='%g' x2='%g' y1='%g' y2='%g' stroke='%s'/>\n", x, x, frame.top, frame.bottom,
                      ratio == 1.0 ? "#444" : "#ddd");
    text += formatted("<text x='%g' y='%g' text-anchor='middle'>%g</text>\n", x, frame.bottom + 16, ratio);
  }
  return text +
         formatted("<text x='%g' y='%g' text-anchor='middle'>planar / this, under the same change</text>\n",
                   0.5 * (frame.left + frame.right), frame.bottom + 36);
}

std::string legend(const SensitivityFrame& frame) {
  std::string text;
  double x = frame.left;
  for (const Kind& kind : kinds) {
    text += formatted("<circle cx='%g' cy='52' r='4' fill='%s'/>\n<text x='%g' y='56'>%s</text>\n", x,
                      kind.color, x + 8, kind.meaning);
    x += 230;
  }
  return text;
}

}  // namespace

std::string SensitivityTable::svg() const {
  const SensitivityFrame frame(*this);
  std::string text = svg::begin(760, frame.bottom + 50) +
                     "<text x='20' y='28' font-size='16'>Sensitivity of " + svg::escaped(name) + "</text>\n" +
                     axis(frame) + legend(frame);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = frame.y(i);
    text += formatted("<text x='%g' y='%g' text-anchor='end'>%s%s</text>\n", frame.left - 8, y + 4,
                      rows[i].change.c_str(), rows[i].skipped.empty() ? "" : " (skipped)");
    for (const Kind& kind : kinds)
      if (const auto ratio = (rows[i].*kind.ratio)(); ratio && *ratio > 0.0)
        text += formatted("<circle cx='%g' cy='%g' r='4' fill='%s'/>\n", frame.x(*ratio), y, kind.color);
  }
  return text + "</svg>\n";
}

}  // namespace fabseq
