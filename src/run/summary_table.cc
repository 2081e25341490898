// SPDX-License-Identifier: MIT
#include "fabseq/run/summary_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <utility>

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

/// A sequence with the title of its column; nullptr: there is none.
struct Column {
  std::string title;
  const SequenceNumbers* sequence;
};

/// Builds the lines: a label, a cell per sequence and, if there are several, two ratios.
class Table {
 public:
  Table(const std::string& unit, std::vector<Column> columns) : columns_(std::move(columns)) {
    std::vector<std::string> titles;
    for (const Column& column : columns_) titles.push_back(column.title);
    if (compares()) titles.insert(titles.end(), {"planar/binary", "start/binary"});
    line(unit.empty() ? "lengths" : "lengths in " + unit, titles);
  }

  /// A row of lengths, with ratios; left out if no sequence has it.
  void lengths(const std::string& label, const Value& value) {
    const auto of = of_all(value);
    if (!of.back()) return;
    std::vector<std::string> cells = texts(of, "%.4g");
    if (compares())
      for (const std::size_t other : {planar, start}) cells.push_back(ratio(of[other], *of.back()));
    line(label, cells);
  }
  /// A row without ratios, left out if no sequence has it.
  void numbers(const std::string& label, const char* format, const Value& value) {
    const auto of = of_all(value);
    if (of.back()) line(label, texts(of, format));
  }
  void heading(const std::string& text) { lines.push_back(text); }

  std::vector<std::string> lines;

 private:
  using Values = std::vector<std::optional<double>>;
  static constexpr std::size_t start = 0, planar = 1;

  bool compares() const { return columns_.size() > 1; }
  /// Values in the order of the columns, of which the binary layers are the last.
  Values of_all(const Value& value) const {
    Values result;
    for (const Column& column : columns_)
      result.push_back(column.sequence != nullptr ? value(*column.sequence) : std::nullopt);
    return result;
  }
  static std::vector<std::string> texts(const Values& values, const char* format) {
    std::vector<std::string> result;
    for (const auto& value : values) result.push_back(number(value, format));
    return result;
  }
  static std::string ratio(const std::optional<double>& length, double of_binary) {
    return length && of_binary > 0.0 ? number(*length / of_binary, "%.1f") : "-";
  }
  void line(const std::string& label, const std::vector<std::string>& cells) {
    constexpr std::size_t label_width = 30, least_width = 11;
    std::string text = label + std::string(label.size() < label_width ? label_width - label.size() : 0, ' ');
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::size_t title = i < columns_.size() ? columns_[i].title.size() : 13;
      text += padded(cells[i], std::max(least_width, title + 2));
    }
    lines.push_back(text);
  }

  std::vector<Column> columns_;
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

void add_distortion(Table& table) {
  table.lengths("first distortion", [](const SequenceNumbers& of) -> std::optional<double> {
    return std::sqrt(of.first_objective());
  });
}

/// How far the part is from the drawing, as built and, if `numbers` say so, after the release.
void add_finished(Table& table, const SequenceNumbers& numbers) {
  table.heading("as built");
  add_deviations(table, false);
  if (!numbers.finished || !numbers.finished->released) return;
  table.heading("after the release");
  add_deviations(table, true);
}

using OfBuild = std::function<std::optional<double>(const BuildNumbers&)>;

Value of_build(const OfBuild& value) {
  return [=](const SequenceNumbers& of) { return of.build ? value(*of.build) : std::nullopt; };
}

Value of_thickness(const std::function<std::optional<double>(const ThicknessRange&)>& value) {
  return of_build(
      [=](const BuildNumbers& of) { return of.local_thickness ? value(*of.local_thickness) : std::nullopt; });
}

void add_build(Table& table) {
  constexpr double percent = 100.0;
  const auto share = [](std::optional<double> value) {
    return value ? std::optional(percent * *value) : std::nullopt;
  };
  table.numbers("layers", "%.0f",
                [](const SequenceNumbers& of) { return std::optional<double>(of.used_layers()); });
  table.numbers("  local thickness, least", "%.4g",
                of_thickness([](const ThicknessRange& of) { return std::optional(of.least); }));
  table.numbers("  local thickness, largest", "%.4g",
                of_thickness([](const ThicknessRange& of) { return std::optional(of.largest); }));
  table.numbers("  outside its range, % of part", "%.1f", of_thickness([=](const ThicknessRange& of) {
                  return of.outside ? share(of.outside->share) : std::nullopt;
                }));
  table.numbers("  out of the torch's reach, %", "%.1f", of_build([=](const BuildNumbers& of) {
                  return of.blocked ? share(of.blocked->share) : std::nullopt;
                }));
  table.numbers("  largest tilt, degrees", "%.1f", of_build([](const BuildNumbers& of) {
                  return of.tilt ? std::optional(of.tilt->largest) : std::nullopt;
                }));
  table.numbers("  tilted beyond the limit, %", "%.1f", of_build([=](const BuildNumbers& of) {
                  return of.tilt ? share(of.tilt->beyond.share) : std::nullopt;
                }));
  const auto add_count = [&](const char* label, MarkedElements BuildNumbers::*marked) {
    table.numbers(label, "%.0f", of_build([=](const BuildNumbers& of) {
                    return std::optional(static_cast<double>((of.*marked).elements));
                  }));
  };
  add_count("  elements that hang in the air", &BuildNumbers::hanging);
  add_count("  nothing earlier beside them", &BuildNumbers::interior_minima);
  add_count("  nothing later beside them", &BuildNumbers::interior_maxima);
  table.numbers("build time, h", "%.3g", of_build([](const BuildNumbers& of) { return of.hours; }));
  table.numbers("wire, kg", "%.4g", of_build([](const BuildNumbers& of) { return of.wire; }));
  table.numbers("stress beyond yield, % of part", "%.1f", of_build([=](const BuildNumbers& of) {
                  return of.stress ? share(of.stress->share_beyond_yield) : std::nullopt;
                }));
}

/// What is to be known of the planar layers, which all others are compared with.
std::string words_on_planar(const SequenceNumbers& planar) {
  if (!planar.build || planar.build->hanging.elements == 0) return "";
  std::string place;
  for (const double coordinate : planar.build->hanging.at)
    place += (place.empty() ? "[" : ",") + number(coordinate, "%.6g");
  return "planar layers: " + std::to_string(planar.build->hanging.elements) +
         " elements begin in the air, the first near " + place + "]; a comparison with them flatters";
}

}  // namespace

std::vector<std::string> summary_table(const Summary& summary) {
  const Finish& finish = *summary.finish;
  std::vector<Column> columns = {{"start", finish.start}, {"planar", summary.baseline}};
  if (finish.matched != nullptr)
    columns.push_back(
        {"planar, " + std::to_string(finish.matched->layers.size()) + " layers", finish.matched});
  columns.push_back({"optimized", &finish.optimized});
  columns.push_back({"binary", &finish.binary});
  Table table(summary.unit, std::move(columns));
  if (summary.baseline->first_is_distortion()) add_distortion(table);
  add_finished(table, finish.binary);
  add_build(table);
  if (const std::string words = words_on_planar(*summary.baseline); !words.empty()) table.heading(words);
  return std::move(table.lines);
}

std::vector<std::string> simulation_table(const SequenceNumbers& numbers, const std::string& unit) {
  Table table(unit, {{"simulated", &numbers}});
  if (numbers.first_is_distortion()) add_distortion(table);
  add_finished(table, numbers);
  add_build(table);
  return std::move(table.lines);
}

}  // namespace fabseq
