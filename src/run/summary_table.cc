// SPDX-License-Identifier: MIT
#include "fabseq/run/summary_table.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>

namespace fabseq {

namespace {

using Value = std::function<std::optional<double>(const SequenceNumbers&)>;

std::string padded(const std::string& text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string number(const std::optional<double>& value, const char* format) {
  if (!value) return "-";
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), format, *value);
  return text.data();
}

/// Builds the lines: a label, a cell per sequence and the two ratios.
class Table {
 public:
  explicit Table(const Summary& summary)
      : sequences_{summary.finish->start, summary.baseline, &summary.finish->optimized,
                   &summary.finish->binary} {
    line(summary.unit.empty() ? "lengths" : "lengths in " + summary.unit,
         {"start", "planar", "optimized", "binary", "planar/binary", "start/binary"});
  }

  /// A row of lengths, with ratios; left out if no sequence has it.
  void lengths(const std::string& label, const Value& value) {
    const auto of = of_all(value);
    if (!of[binary]) return;
    line(label, {number(of[0], "%.4g"), number(of[planar], "%.4g"), number(of[2], "%.4g"),
                 number(of[binary], "%.4g"), ratio(of[planar], *of[binary]), ratio(of[0], *of[binary])});
  }
  void counts(const std::string& label, const Value& value) {
    const auto of = of_all(value);
    line(label, {number(of[0], "%.0f"), number(of[planar], "%.0f"), number(of[2], "%.0f"),
                 number(of[binary], "%.0f")});
  }
  void heading(const std::string& text) { lines.push_back(text); }

  std::vector<std::string> lines;

 private:
  static constexpr int planar = 1, binary = 3;

  std::array<std::optional<double>, 4> of_all(const Value& value) const {
    std::array<std::optional<double>, 4> result;
    for (std::size_t i = 0; i < result.size(); ++i)
      if (sequences_[i] != nullptr) result[i] = value(*sequences_[i]);
    return result;
  }
  static std::string ratio(const std::optional<double>& length, double of_binary) {
    return length && of_binary > 0.0 ? number(*length / of_binary, "%.1f") : "-";
  }
  void line(const std::string& label, const std::vector<std::string>& cells) {
    std::string text = label + std::string(label.size() < 30 ? 30 - label.size() : 0, ' ');
    for (std::size_t i = 0; i < cells.size(); ++i) text += padded(cells[i], i < 4 ? 11 : 15);
    lines.push_back(text);
  }

  std::array<const SequenceNumbers*, 4> sequences_;  ///< in the order of the columns; nullptr: there is none
};

using OfDeviation = std::function<std::optional<double>(const Deviation&)>;

/// A row of what is measured on the part as built, or after its release.
void add_deviation(Table& table, const std::string& label, bool released, const OfDeviation& value) {
  table.lengths(label, [&](const SequenceNumbers& of) -> std::optional<double> {
    if (!of.finished || (released && !of.finished->released)) return std::nullopt;
    return value(released ? *of.finished->released : of.finished->as_built);
  });
}

void add_deviations(Table& table, bool released) {
  const auto nodes = [](double DisplacementSize::*size) {
    return [=](const Deviation& of) -> std::optional<double> {
      return of.nodes ? std::optional((*of.nodes).*size) : std::nullopt;
    };
  };
  const auto part = [](double DisplacementSize::*size) {
    return [=](const Deviation& of) { return std::optional(of.part.*size); };
  };
  add_deviation(table, "  objective's nodes, rms", released, nodes(&DisplacementSize::rms));
  add_deviation(table, "  objective's nodes, largest", released, nodes(&DisplacementSize::largest));
  add_deviation(table, "  whole part, rms", released, part(&DisplacementSize::rms));
  add_deviation(table, "  whole part, largest", released, part(&DisplacementSize::largest));
  add_deviation(table, "  skin outside the drawing", released,
                [](const Deviation& of) { return std::optional(of.outward); });
  add_deviation(table, "  skin inside the drawing", released,
                [](const Deviation& of) { return std::optional(of.inward); });
}

}  // namespace

std::vector<std::string> summary_table(const Summary& summary) {
  Table table(summary);
  if (summary.baseline->first_is_distortion())
    table.lengths("first distortion", [](const SequenceNumbers& of) -> std::optional<double> {
      return std::sqrt(of.first_objective());
    });
  table.heading("as built");
  add_deviations(table, false);
  if (const auto& finished = summary.finish->binary.finished; finished && finished->released) {
    table.heading("after the release");
    add_deviations(table, true);
  }
  table.counts("layers", [](const SequenceNumbers& of) -> std::optional<double> { return of.used_layers(); });
  return std::move(table.lines);
}

}  // namespace fabseq
