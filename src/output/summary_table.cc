// SPDX-License-Identifier: MIT
#include "fabseq/output/summary_table.h"

#include "fabseq/base/formatted.h"

#include <algorithm>
#include <functional>
#include <optional>

namespace fabseq {

namespace {

constexpr std::size_t most_places = 5, most_remarks = 4;

/// A sequence with the name of its row.
struct Row {
  std::string title;
  const SequenceNumbers* sequence;
};

std::string number(const std::optional<double>& value, const char* format = "%.3g") {
  return value ? formatted(format, *value) : "-";
}

std::optional<double> largest_tilt(const SequenceNumbers& of) {
  return of.build && of.build->tilt ? std::optional(of.build->tilt->largest) : std::nullopt;
}

/// "0.53 to 1.4"
std::string thickness_words(const SequenceNumbers& of) {
  if (!of.build || !of.build->local_thickness) return "-";
  const ThicknessRange& range = *of.build->local_thickness;
  return formatted("%.2g to ", range.least) +
         (range.largest_is_meeting ? "(fronts meet)" : formatted("%.2g", range.largest));
}

/// A column of the table. One without any value is left out.
struct Column {
  std::string title;
  std::function<std::string(const SequenceNumbers&)> cell;
};

std::vector<Column> columns(bool released, bool has_limit_of_tilt) {
  const auto skin = [released](const SequenceNumbers& of) { return of.finished->deviation(released).skin; };
  const auto hours = [](const SequenceNumbers& of) {
    const auto& heat = of.part_temperature;
    if (heat && heat->pauses) return heat->pauses->hours;  // with the pauses that keep the limit
    return of.build ? of.build->hours : std::nullopt;
  };
  const auto interpass = [](const SequenceNumbers& of) {
    const auto& heat = of.part_temperature;
    return heat && heat->highest.layer > 0 ? std::optional(heat->highest.value) : std::nullopt;
  };
  return {
      {"rms", [skin](const SequenceNumbers& of) { return number(skin(of).rms); }},
      {"largest", [skin](const SequenceNumbers& of) { return number(skin(of).largest); }},
      {"layers", [](const SequenceNumbers& of) { return std::to_string(of.used_layers()); }},
      {"hours", [hours](const SequenceNumbers& of) { return number(hours(of)); }},
      {has_limit_of_tilt ? "tilt" : "tilt (no limit)",
       [](const SequenceNumbers& of) { return number(largest_tilt(of), "%.0f"); }},
      {"interpass, deg C", [interpass](const SequenceNumbers& of) { return number(interpass(of), "%.0f"); }},
      {"thickness", thickness_words}};
}

/// A heading and a line for each row, the class of the sequence at its end.
std::vector<std::string> rows_of(const std::vector<Row>& rows, const ModelSettings& settings, bool released) {
  std::vector<std::string> lines = {std::string("skin ") + (released ? "after the release" : "as built") +
                                    (settings.unit.empty() ? "" : ", " + settings.unit)};
  for (const Row& row : rows) lines.push_back("  " + row.title);
  std::size_t longest = 0;
  for (const std::string& line : lines) longest = std::max(longest, line.size());
  for (std::string& line : lines) line.resize(longest, ' ');
  for (const auto& [title, cell] : columns(released, settings.tool.max_tilt < 180.0)) {
    std::vector<std::string> cells = {title};
    for (const Row& row : rows) cells.push_back(cell(*row.sequence));
    if (std::all_of(cells.begin() + 1, cells.end(), [](const std::string& text) { return text == "-"; }))
      continue;
    std::size_t width = 0;
    for (const std::string& text : cells) width = std::max(width, text.size());
    for (std::size_t i = 0; i < cells.size(); ++i)
      lines[i] += "  " + std::string(width - cells[i].size(), ' ') + cells[i];
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].sequence->verdict) lines[i + 1] += "  " + rows[i].sequence->verdict->class_words();
  return lines;
}

/// At most so many, then how many more there are.
void add_some(std::vector<std::string>& lines, const std::vector<std::string>& texts, std::size_t most,
              std::int64_t in_all) {
  const std::size_t told = std::min(most, texts.size());
  lines.insert(lines.end(), texts.begin(), texts.begin() + static_cast<std::ptrdiff_t>(told));
  const std::int64_t others = in_all - static_cast<std::int64_t>(told);
  if (others > 0)
    lines.push_back(std::to_string(others) + (others == 1 ? " other place" : " other places") +
                    ": places in summary.json");
}

std::int64_t places_in_all(const SequenceNumbers& of) {
  return of.build && of.build->places ? of.build->places->in_all : 0;
}

/// What a sequence's checks go by where it has no gradient itself.
std::string words_on_gradient(const SequenceNumbers& of) {
  const std::string begin = "checks of direction and thickness: ";
  switch (of.build ? of.build->gradient : GradientSource::sequence) {
    case GradientSource::file:
      return begin + "by the gradient recorded beside the times";
    case GradientSource::differences:
      return begin + "by differences of the elements' times, which come without a gradient";
    case GradientSource::layer_differences:
      return begin + "estimates, by differences of times that are no finer than layers";
    default:
      return "";
  }
}

}  // namespace

std::vector<std::string> summary_table(const Summary& summary) {
  const FinalReports& reports = summary.finish->reports;
  const Headline& headline = summary.finish->headline;
  std::vector<Row> rows = {{"planar", summary.baseline}};
  for (const Baseline& baseline : reports.baselines)
    if (headline.alternative && headline.alternative->block == baseline.block)
      rows.push_back({baseline.title, &baseline.numbers});
  rows.push_back({"optimized", &reports.binary});
  std::vector<std::string> lines = {headline.words.front()};
  for (std::string& row : rows_of(rows, summary.settings, headline.released)) lines.push_back(std::move(row));
  add_some(lines, headline.places, most_places, places_in_all(reports.binary));
  std::vector<std::string> remarks(headline.words.begin() + 1, headline.words.end());
  if (std::string words = words_on_gradient(reports.binary); !words.empty())
    remarks.push_back(std::move(words));
  lines.insert(lines.end(), remarks.begin(),
               remarks.begin() + static_cast<std::ptrdiff_t>(std::min(remarks.size(), most_remarks)));
  return lines;
}

std::vector<std::string> simulation_table(const SequenceNumbers& numbers, const ModelSettings& settings) {
  std::vector<std::string> lines;
  if (numbers.verdict) lines.push_back(numbers.verdict->words());
  const bool released = numbers.finished->released.has_value();
  for (std::string& row : rows_of({{"simulated", &numbers}}, settings, released))
    lines.push_back(std::move(row));
  std::vector<std::string> places;
  if (numbers.build && numbers.build->places)
    for (const Place& place : numbers.build->places->largest)
      places.push_back(words_of(place, *numbers.build->places, settings));
  add_some(lines, places, most_places, places_in_all(numbers));
  if (std::string words = words_on_gradient(numbers); !words.empty()) lines.push_back(std::move(words));
  return lines;
}

}  // namespace fabseq
