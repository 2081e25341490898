// SPDX-License-Identifier: MIT
#include "fabseq/run/sensitivity.h"
#include "fabseq/run/svg.h"

#include <algorithm>
#include <cmath>
#include <sstream>

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

void draw_axis(std::ostringstream& text, const SensitivityFrame& frame) {
  text << "<rect x='" << frame.left << "' y='" << frame.top << "' width='" << frame.right - frame.left
       << "' height='" << frame.bottom - frame.top << "' fill='none' stroke='#999'/>\n";
  for (const double ratio : ticks(frame)) {
    const double x = frame.x(ratio);
    text << "<line x1='" << x << "' x2='" << x << "' y1='" << frame.top << "' y2='" << frame.bottom
         << "' stroke='" << (ratio == 1.0 ? "#444" : "#ddd") << "'/>\n<text x='" << x << "' y='"
         << frame.bottom + 16 << "' text-anchor='middle'>" << ratio << "</text>\n";
  }
  text << "<text x='" << 0.5 * (frame.left + frame.right) << "' y='" << frame.bottom + 36
       << "' text-anchor='middle'>planar / this, under the same change</text>\n";
}

void draw_legend(std::ostringstream& text, const SensitivityFrame& frame) {
  double x = frame.left;
  for (const Kind& kind : kinds) {
    text << "<circle cx='" << x << "' cy='52' r='4' fill='" << kind.color << "'/>\n<text x='" << x + 8
         << "' y='56'>" << kind.meaning << "</text>\n";
    x += 230;
  }
}

}  // namespace

std::string SensitivityTable::svg() const {
  const SensitivityFrame frame(*this);
  std::ostringstream text;
  text << svg::begin(760, frame.bottom + 50) << "<text x='20' y='28' font-size='16'>Sensitivity of "
       << svg::escaped(name) << "</text>\n";
  draw_axis(text, frame);
  draw_legend(text, frame);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = frame.y(i);
    text << "<text x='" << frame.left - 8 << "' y='" << y + 4 << "' text-anchor='end'>" << rows[i].change
         << (rows[i].skipped.empty() ? "" : " (skipped)") << "</text>\n";
    for (const Kind& kind : kinds)
      if (const auto ratio = (rows[i].*kind.ratio)(); ratio && *ratio > 0.0)
        text << "<circle cx='" << frame.x(*ratio) << "' cy='" << y << "' r='4' fill='" << kind.color
             << "'/>\n";
  }
  text << "</svg>\n";
  return text.str();
}

}  // namespace fabseq
