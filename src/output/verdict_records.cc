// SPDX-License-Identifier: MIT
#include "output/verdict_records.h"

namespace fabseq {

namespace {

void add_compared(Json& record, const char* key, const std::optional<ComparedSequence>& compared) {
  if (!compared) return;
  record[key] = Json::object({{"block", compared->block},
                              {"title", compared->title},
                              {"length", compared->length},
                              {"ratio", compared->ratio},
                              {"buildable", compared->buildable}});
}

}  // namespace

Json to_record(const Verdict& verdict) {
  Json reasons = Json::array();
  for (const auto& [name, share, worst, at, words] : verdict.broken)
    reasons.push_back(
        Json::object({{"name", name}, {"share", share}, {"worst", worst}, {"at", at}, {"words", words}}));
  return Json::object({{"buildable", verdict.buildable()}, {"words", verdict.words()}, {"reasons", reasons}});
}

Json to_record(const Headline& headline) {
  Json record = Json::object({{"of", "skin"}, {"released", headline.released}, {"length", headline.length}});
  add_compared(record, "baseline", headline.baseline);
  add_compared(record, "planar", headline.planar);
  add_compared(record, "start", headline.start);
  if (headline.scaled)
    record["scaled_drawing"] =
        Json::object({{"factor", headline.scaled->factor}, {"length", headline.scaled->rms}});
  record["words"] = headline.words;
  return record;
}

Json to_record(const ConstraintLimit& limit) {
  Json bounds = Json::array();
  for (const ConstraintRow& row : limit.rows)
    bounds.push_back(Json::object(
        {{"sign", row.sign}, {"bound", row.bound}, {"scale", row.logarithmic ? 1.0 : row.scale}}));
  return Json::object({{"type", limit.type}, {"unit", limit.unit}, {"bounds", bounds}});
}

Json to_record(const ConstraintMiss& miss) {
  return Json::object({{"name", miss.name},
                       {"type", miss.type},
                       {"value", miss.value},
                       {"bound", miss.bound},
                       {"words", miss.words}});
}

void add_directions(Json& record, const Baseline& baseline) {
  if (baseline.direction.empty()) return;
  Json tried = Json::array();
  for (const auto& [direction, tilt, length, buildable] : baseline.tried)
    tried.push_back(Json::object(
        {{"direction", direction}, {"tilt", tilt}, {"length", length}, {"buildable", buildable}}));
  record["direction"] = baseline.direction;
  record["scan"] = Json::object({{"elements", baseline.tried_on}, {"directions", tried}});
}

}  // namespace fabseq
