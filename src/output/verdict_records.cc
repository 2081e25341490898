// SPDX-License-Identifier: MIT
#include "output/verdict_records.h"

namespace fabseq {

namespace {

Json compared_record(const std::optional<ComparedSequence>& compared) {
  if (!compared) return {};
  return Json::object({{"block", compared->block},
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
  Json scaled;
  if (headline.scaled)
    scaled = Json::object({{"factor", headline.scaled->factor}, {"length", headline.scaled->rms}});
  return Json::object({{"of", "skin"},
                       {"released", headline.released},
                       {"length", headline.length},
                       {"baseline", compared_record(headline.baseline)},
                       {"planar", compared_record(headline.planar)},
                       {"start", compared_record(headline.start)},
                       {"scaled_drawing", scaled},
                       {"words", headline.words}});
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
