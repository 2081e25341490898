// SPDX-License-Identifier: MIT
#include "fabseq/output/summary_table.h"

#include "fabseq/base/formatted.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

namespace fabseq {

namespace {

constexpr std::size_t most_places = 5, most_remarks = 4;

/// A sequence with the name of its row.
struct Row {
  std::string title;
  const SequenceNumbers* sequence;
};

/// A column of the table, with a cell for each row; "-": no value.
struct Column {
  std::string title;
  std::vector<std::string> cells;
  int rank = 0;  ///< of what findings add
};

/// What findings add: a sequence without a cell in one of their columns has no value there.
std::vector<Column> columns_of_findings(const std::vector<Row>& rows) {
  std::vector<Column> result;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const Found::Entry& entry : rows[i].sequence->found.entries())
      for (const TableCell& cell : entry.numbers->cells(rows[i].sequence->found)) {
        auto column = std::find_if(result.begin(), result.end(),
                                   [&](const Column& other) { return other.title == cell.title; });
        if (column == result.end())
          column = result.insert(result.end(),
                                 {cell.title, std::vector<std::string>(rows.size(), "-"), cell.rank});
        column->cells[i] = cell.text;
      }
  std::stable_sort(result.begin(), result.end(),
                   [](const Column& a, const Column& b) { return a.rank < b.rank; });
  return result;
}

std::vector<Column> columns_of(const std::vector<Row>& rows, bool released) {
  std::vector<Column> result = {{"rms", {}}, {"largest", {}}, {"layers", {}}};
  for (const Row& row : rows) {
    const DisplacementSize& skin = row.sequence->finished->deviation(released).skin;
    result[0].cells.push_back(formatted("%.3g", skin.rms));
    result[1].cells.push_back(formatted("%.3g", skin.largest));
    result[2].cells.push_back(std::to_string(row.sequence->used_layers()));
  }
  std::ranges::move(columns_of_findings(rows), std::back_inserter(result));
  return result;
}

/// A heading and a line for each row, the class of the sequence at its end.
std::vector<std::string> rows_of(const std::vector<Row>& rows, const ModelSettings& settings, bool released) {
  std::vector<std::string> lines = {std::string("skin ") + (released ? "after the release" : "as built") +
                                    (settings.unit.empty() ? "" : ", " + settings.unit)};
  for (const Row& row : rows) lines.push_back("  " + row.title);
  std::size_t longest = 0;
  for (const std::string& line : lines) longest = std::max(longest, line.size());
  for (std::string& line : lines) line.resize(longest, ' ');
  for (Column& column : columns_of(rows, released)) {
    std::vector<std::string>& cells = column.cells;
    if (std::ranges::all_of(cells, [](const std::string& text) { return text == "-"; })) continue;
    cells.insert(cells.begin(), column.title);
    std::size_t width = 0;
    for (const std::string& text : cells) width = std::max(width, text.size());
    for (std::size_t i = 0; i < cells.size(); ++i)
      lines[i] += "  " + std::string(width - cells[i].size(), ' ') + cells[i];
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].sequence->verdict) lines[i + 1] += "  " + rows[i].sequence->verdict->class_words();
  return lines;
}

/// Adds at most so many, then how many more there are.
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
  return of.found.places ? of.found.places->in_all : 0;
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
  if (const auto& real = reports.binary.real_layers) {
    lines.push_back(words_of(*real));
    if (real->lumping) lines.push_back(words_of(*real->lumping, summary.settings.unit));
  }
  add_some(lines, headline.places, most_places, places_in_all(reports.binary));
  std::vector<std::string> remarks(headline.words.begin() + 1, headline.words.end());
  std::ranges::move(reports.binary.found.words_in(ToldIn::table), std::back_inserter(remarks));
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
  if (numbers.real_layers) lines.push_back(words_of(*numbers.real_layers));
  std::vector<std::string> places;
  if (numbers.found.places)
    for (const Place& place : numbers.found.places->largest)
      places.push_back(words_of(place, *numbers.found.places, settings));
  add_some(lines, places, most_places, places_in_all(numbers));
  std::ranges::move(numbers.found.words_in(ToldIn::table), std::back_inserter(lines));
  return lines;
}

}  // namespace fabseq
