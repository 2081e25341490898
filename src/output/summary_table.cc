// SPDX-License-Identifier: MIT
#include "fabseq/output/summary_table.h"

#include "fabseq/base/formatted.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fabseq {

namespace {

/// Title of the column of smooth layers.
constexpr const char* smooth = "optimized";

/// What a line of the table says of one sequence.
struct Row {
  std::string label;
  const char* format;           ///< of the value; nullptr: the label is a heading
  std::optional<double> value;  ///< none: the sequence has none; of a heading: nothing stands below it
  bool is_length = false;       ///< compared by ratios
};

/// A member of what there may not be.
template <class Struct>
std::optional<double> member(const std::optional<Struct>& of, double Struct::*value) {
  return of ? std::optional((*of).*value) : std::nullopt;
}

std::optional<double> in_percent(const std::optional<double>& share) {
  return share ? std::optional(100.0 * *share) : std::nullopt;
}

/// How far the part is from the drawing.
void add_deviation(std::vector<Row>& rows, const char* heading, const std::optional<Deviation>& measured) {
  const Deviation of = measured.value_or(Deviation{});
  rows.push_back({heading, nullptr, measured ? std::optional(0.0) : std::nullopt});
  const auto add = [&](const char* label, const std::optional<double>& length) {
    rows.push_back({label, "%.4g", measured ? length : std::nullopt, true});
  };
  add("  objective's nodes, rms", member(of.nodes, &DisplacementSize::rms));
  add("  objective's nodes, largest", member(of.nodes, &DisplacementSize::largest));
  add("  whole part, rms", of.part.rms);
  add("  whole part, largest", of.part.largest);
  add("  skin outside the drawing", of.outward);
  add("  skin inside the drawing", of.inward);
}

void add_build(std::vector<Row>& rows, const BuildNumbers& build) {
  const auto share = [](const std::optional<MarkedElements>& marked) {
    return in_percent(member(marked, &MarkedElements::share));
  };
  const auto count = [](const MarkedElements& marked) { return static_cast<double>(marked.elements); };
  const auto& thickness = build.local_thickness;
  rows.insert(
      rows.end(),
      {{"  local thickness, least", "%.4g", member(thickness, &ThicknessRange::least)},
       {"  local thickness, largest", "%.4g", member(thickness, &ThicknessRange::largest)},
       {"  outside its range, % of part", "%.1f", thickness ? share(thickness->outside) : std::nullopt},
       {"  out of the torch's reach, %", "%.1f", share(build.blocked)},
       {"  largest tilt, degrees", "%.1f", member(build.tilt, &TiltNumbers::largest)},
       {"  tilted beyond the limit, %", "%.1f", build.tilt ? share(build.tilt->beyond) : std::nullopt},
       {"  elements that hang in the air", "%.0f", count(build.hanging)},
       {"  nothing earlier beside them", "%.0f", count(build.interior_minima)},
       {"  nothing later beside them", "%.0f", count(build.interior_maxima)},
       {"build time, h", "%.3g", build.hours},
       {"wire, kg", "%.4g", build.wire},
       {"stress beyond yield, % of part", "%.1f",
        in_percent(member(build.stress, &StressNumbers::share_beyond_yield))}});
}

/// The same rows, without values where there are no temperatures.
void add_temperature(std::vector<Row>& rows, const std::optional<TemperatureNumbers>& of) {
  const auto value = [&](LayerTemperature TemperatureNumbers::*which) {
    return of && ((*of).*which).layer > 0 ? std::optional(((*of).*which).value) : std::nullopt;
  };
  rows.insert(rows.end(),
              {{"highest interpass, degrees C", "%.1f", value(&TemperatureNumbers::highest)},
               {"hottest as a layer begins", "%.1f", value(&TemperatureNumbers::hottest)},
               {"build time at its limit, h", "%.3g", of && of->pauses ? of->pauses->hours : std::nullopt}});
}

/// The same rows for every sequence.
std::vector<Row> rows_of(const SequenceNumbers& of) {
  std::vector<Row> rows;
  const double objective = of.first_objective();
  rows.push_back({"first distortion", "%.4g",
                  of.first_is_distortion() ? std::optional(std::sqrt(objective)) : std::nullopt, true});
  add_deviation(rows, "as built", of.finished->as_built);
  add_deviation(rows, "after the release", of.finished->released);
  rows.push_back({"layers", "%.0f", of.used_layers()});
  add_build(rows, *of.build);
  add_temperature(rows, of.part_temperature);
  return rows;
}

std::string number(const std::optional<double>& value, const char* format) {
  return value ? formatted(format, *value) : "-";
}

/// Cells under titles of their width.
std::string line(const std::string& label, const std::vector<std::string>& cells,
                 const std::vector<std::string>& titles) {
  constexpr int least_width = 11;
  std::string text = formatted("%-30s", label.c_str());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int width = std::max(least_width, static_cast<int>(titles[i].size()) + 2);
    text += formatted("%*s", width, cells[i].c_str());
  }
  return text;
}

/// A sequence with the title of its column; nullptr: there is none.
struct Column {
  std::string title;
  const SequenceNumbers* sequence;
};

/// A label, a cell per sequence and, if there are several, two ratios of lengths. Rows that the last sequence
/// has no value for are left out.
std::vector<std::string> table(const std::string& unit, const std::vector<Column>& columns) {
  const bool compares = columns.size() > 1;
  std::vector<std::string> titles;
  std::vector<std::vector<Row>> rows;  // of each column; empty without a sequence
  for (const auto& [title, sequence] : columns) {
    titles.push_back(title);
    rows.push_back(sequence == nullptr ? std::vector<Row>() : rows_of(*sequence));
  }
  if (compares) titles.insert(titles.end(), {"planar/binary", " start/binary"});  // of the same width
  std::vector<std::string> lines = {line(unit.empty() ? "lengths" : "lengths in " + unit, titles, titles)};
  for (std::size_t i = 0; i < rows.back().size(); ++i) {
    const auto& [label, format, last, is_length] = rows.back()[i];
    if (!last) continue;
    const auto value = [&, i](std::size_t column) {
      return rows[column].empty() ? std::nullopt : rows[column][i].value;
    };
    std::vector<std::string> cells;
    for (std::size_t c = 0; c < columns.size() && format != nullptr; ++c)
      cells.push_back(number(value(c), format));
    for (const std::size_t other : {1, 0}) {
      if (!compares || !is_length) break;
      cells.push_back(value(other) && *last > 0.0 ? number(*value(other) / *last, "%.1f") : "-");
    }
    lines.push_back(cells.empty() ? label : line(label, cells, titles));
  }
  return lines;
}

/// Whether each of the sequences can be built; the smooth layers never are.
void add_verdicts(std::vector<std::string>& lines, const std::vector<Column>& columns) {
  lines.emplace_back("buildable on this machine");
  for (const auto& [title, sequence] : columns)
    if (sequence != nullptr && title != smooth)
      lines.push_back(formatted("  %-28s", title.c_str()) + sequence->verdict->words());
}

/// What is to be known of the thickest place: a meeting of fronts is no thick layer.
std::string words_on_thickness(const SequenceNumbers& of, const std::string& unit) {
  const auto& thickness = of.build->local_thickness;
  if (!thickness || !thickness->outside || thickness->outside->elements == 0) return "";
  const std::string words =
      thickness->largest_is_meeting
          ? ": fronts meet there, where the gradient of the time vanishes; it is no thick layer"
          : ": a thick layer";
  return "largest local thickness of the binary layers: " + length_words(thickness->largest, unit) + " " +
         near_words(thickness->largest_at) + words;
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
  std::vector<Column> columns = {{"start", reports.start ? &*reports.start : nullptr},
                                 {"planar", summary.baseline}};
  for (const Baseline& baseline : reports.baselines) columns.push_back({baseline.title, &baseline.numbers});
  columns.push_back({smooth, &reports.optimized});
  columns.push_back({"binary", &reports.binary});
  std::vector<std::string> lines = table(summary.unit, columns);
  add_verdicts(lines, columns);
  for (const std::string& words :
       {words_on_gradient(reports.binary), words_on_thickness(reports.binary, summary.unit)})
    if (!words.empty()) lines.push_back(words);
  for (const std::string& words : summary.finish->headline.words) lines.push_back(words);
  return lines;
}

std::vector<std::string> simulation_table(const SequenceNumbers& numbers, const std::string& unit) {
  std::vector<std::string> lines = table(unit, {{"simulated", &numbers}});
  if (numbers.verdict) lines.push_back("buildable on this machine: " + numbers.verdict->words());
  if (const std::string words = words_on_gradient(numbers); !words.empty()) lines.push_back(words);
  return lines;
}

}  // namespace fabseq
