// SPDX-License-Identifier: MIT
#include "fabseq/base/formatted.h"
#include "tasks/sensitivity.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// Relative change of a ratio from twice to four times as many layers that is small enough to go on from.
constexpr double settled = 0.05;

Json to_record(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

/// Length of a distortion.
std::optional<double> length_of(const std::optional<double>& distortion) {
  return distortion ? std::optional(std::sqrt(*distortion)) : std::nullopt;
}

std::optional<double> first_length(const VariedNumbers& numbers) {
  return numbers.distortions.empty() ? std::nullopt : length_of(numbers.distortions.front());
}

Json to_record(const VariedNumbers& numbers, const std::vector<std::string>& terms) {
  Json distortion = Json::array();
  for (std::size_t k = 0; k < terms.size(); ++k)
    distortion.push_back(Json::object({{"name", terms[k]},
                                       {"value", to_record(numbers.distortions[k])},
                                       {"length", to_record(length_of(numbers.distortions[k]))}}));
  Json record = Json::object(
      {{"distortion", distortion},
       {"displacement", Json::object({{"max", to_record(numbers.largest)}, {"rms", numbers.rms}})}});
  if (numbers.rms_deviation)
    record["standard_deviation"] =
        Json::object({{"max", to_record(numbers.largest_deviation)}, {"rms", *numbers.rms_deviation}});
  return record;
}

Json worst_record(const SensitivityTable& table, SensitivityTable::Ratio ratio) {
  const SensitivityRow* row = table.worst(ratio);
  if (row == nullptr) return {};
  return Json::object({{"ratio", to_record((row->*ratio)())}, {"change", row->change}});
}

/// A number of the table, a dash where there is none.
std::string cell(const char* format, const std::optional<double>& value, int width) {
  return value ? formatted(format, *value) : formatted("%*s", width, "-");
}

std::string line_of(const SensitivityRow& row) {
  const std::string name = formatted("%-44s", row.change.c_str());
  if (!row.skipped.empty()) return name + " skipped: " + row.skipped;
  return name + cell("%12.4e", first_length(row.sequence), 12) +
         cell("%12.4e", first_length(row.planar), 12) + cell("%9.3g", row.length_ratio(), 9) +
         cell("%12.4e", row.sequence.rms, 12) + cell("%12.4e", row.planar.rms, 12) +
         cell("%9.3g", row.rms_ratio(), 9) + cell("%12.4e", row.sequence.largest, 12) +
         cell("%12.4e", row.planar.largest, 12);
}

/// " about 3.2", of what a ratio tends to.
std::string limit_words(const std::optional<double>& limit) {
  return limit ? formatted(" about %.3g", *limit) : " not settled";
}

std::string csv_number(const std::optional<double>& value) {
  return value ? Json(*value).dump() : std::string();
}

std::string csv_numbers(const VariedNumbers& numbers) {
  std::string text;
  for (const auto& distortion : numbers.distortions)
    text += csv_number(distortion) + "," + csv_number(length_of(distortion)) + ",";
  return text + csv_number(numbers.largest) + "," + csv_number(numbers.rms) + "," +
         csv_number(numbers.largest_deviation) + "," + csv_number(numbers.rms_deviation);
}

/// A text as a cell of a CSV file.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char character : text) result += character == '"' ? "\"\"" : std::string(1, character);
  return result + '"';
}

std::optional<double> quotient(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b && *b > 0.0 ? std::optional(*a / *b) : std::nullopt;
}

}  // namespace

std::optional<double> SensitivityRow::length_ratio() const {
  return skipped.empty() ? quotient(first_length(planar), first_length(sequence)) : std::nullopt;
}

std::optional<double> SensitivityRow::rms_ratio() const {
  return skipped.empty() ? quotient(planar.rms, sequence.rms) : std::nullopt;
}

const SensitivityRow* SensitivityTable::worst(Ratio ratio) const {
  const SensitivityRow* result = nullptr;
  for (const SensitivityRow& row : rows) {
    const std::optional<double> value = (row.*ratio)();
    if (value && (result == nullptr || *value < *(result->*ratio)())) result = &row;
  }
  return result;
}

std::optional<double> SensitivityTable::thin_layers(Ratio ratio) const {
  const auto with_layers = [&](int times) -> std::optional<double> {
    // The first row is "unchanged".
    const auto row = std::ranges::find(rows, times, &SensitivityRow::layers_times);
    return row == rows.end() ? std::nullopt : ((*row).*ratio)();
  };
  const auto once = with_layers(1), twice = with_layers(2), four_times = with_layers(4);
  if (!once || !twice || !four_times) return std::nullopt;
  const double last_step = *four_times - *twice;
  // A sequence whose ratio is still on its way has no limit that two steps could tell.
  if (std::abs(last_step) > std::max(std::abs(*twice - *once), settled * *four_times)) return std::nullopt;
  return *four_times + last_step;
}

Json SensitivityTable::json() const {
  Json list = Json::array();
  for (const SensitivityRow& row : rows) {
    Json record = Json::object({{"change", row.change}});
    if (!row.skipped.empty()) {
      record["skipped"] = row.skipped;
    } else {
      record["sequence"] = to_record(row.sequence, terms);
      record["planar"] = to_record(row.planar, terms);
      record["ratio"] =
          Json::object({{"length", to_record(row.length_ratio())}, {"rms", to_record(row.rms_ratio())}});
    }
    list.push_back(record);
  }
  return Json::object(
      {{"name", name},
       {"changes", list},
       {"worst", Json::object({{"length", worst_record(*this, &SensitivityRow::length_ratio)},
                               {"rms", worst_record(*this, &SensitivityRow::rms_ratio)}})},
       {"thin_layers", Json::object({{"length", to_record(thin_layers(&SensitivityRow::length_ratio))},
                                     {"rms", to_record(thin_layers(&SensitivityRow::rms_ratio))}})}});
}

std::string SensitivityTable::csv() const {
  std::string text = "change";
  for (const char* of : {"sequence", "planar"}) {
    for (const std::string& term : terms)
      text += formatted(",%s_%s,%s_%s_length", of, term.c_str(), of, term.c_str());
    for (const char* column : {"max", "rms", "deviation_max", "deviation_rms"})
      text += formatted(",%s_%s", of, column);
  }
  text += ",length_ratio,rms_ratio,skipped\n";
  const std::string empty(std::ranges::count(text, ',') - 1, ',');
  for (const SensitivityRow& row : rows)
    if (row.skipped.empty())
      text += quoted(row.change) + ',' + csv_numbers(row.sequence) + ',' + csv_numbers(row.planar) + ',' +
              csv_number(row.length_ratio()) + ',' + csv_number(row.rms_ratio()) + ",\n";
    else
      text += quoted(row.change) + empty + ',' + quoted(row.skipped) + '\n';
  return text;
}

std::vector<std::string> SensitivityTable::text() const {
  std::vector<std::string> result = {
      "", formatted("%-44s%12s%12s%9s%12s%12s%9s%12s%12s", "change", "length", "planar", "ratio", "rms",
                    "planar", "ratio", "max", "planar")};
  for (const SensitivityRow& row : rows) result.push_back(line_of(row));
  const auto add_worst = [&](const char* of, Ratio ratio) {
    if (const SensitivityRow* row = worst(ratio))
      result.push_back("worst ratio of " + std::string(of) + ":" + cell(" %.3g", (row->*ratio)(), 0) + ", " +
                       row->change);
  };
  add_worst("lengths", &SensitivityRow::length_ratio);
  add_worst("the part's rms", &SensitivityRow::rms_ratio);
  if (std::ranges::any_of(rows, [](const SensitivityRow& row) { return row.layers_times > 1; }))
    result.push_back("with ever thinner layers the ratio tends to: lengths" +
                     limit_words(thin_layers(&SensitivityRow::length_ratio)) + ", the part's rms" +
                     limit_words(thin_layers(&SensitivityRow::rms_ratio)));
  return result;
}

}  // namespace fabseq
