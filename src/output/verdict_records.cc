// SPDX-License-Identifier: MIT
#include "output/verdict_records.h"

namespace fabseq {

namespace {

Json to_record(const ComparedSequence& compared) {
  return Json::object({{"block", compared.block},
                       {"title", compared.title},
                       {"length", compared.length},
                       {"largest", compared.largest},
                       {"ratio", compared.ratio},
                       {"class", name_of(compared.build_class)}});
}

Json to_record(const DistortionLengths& lengths) {
  return Json::object({{"length", lengths.term ? Json(*lengths.term) : Json()}, {"rms", lengths.rms}});
}

/// The thickness over the target, degrees, a depth; nothing of what hangs.
Json worst_of(const Place& place, const Bead& bead) {
  if (place.fault == Fault::hanging) return {};
  return place.fault == Fault::local_thickness ? place.worst / bead.height : place.worst;
}

Json to_record(const Place& place, const FaultyPlaces& all, const ModelSettings& settings) {
  std::vector<double> beads;
  for (std::size_t i = 0; i < place.extent.size(); ++i)
    beads.push_back(place.extent[i] / (i + 1 < place.extent.size() ? all.bead.width : all.bead.height));
  const std::string form = name_of(place.form);
  return Json::object({{"kind", name_of(place.fault)},
                       {"form", form.empty() ? Json() : Json(form)},
                       {"elements", place.elements},
                       {"share", place.volume / all.part_volume},
                       {"volume", place.volume},
                       {"begins", place.begins},
                       {"extent", place.extent},
                       {"beads", beads},
                       {"centre", place.centre},
                       {"lower", place.lower},
                       {"upper", place.upper},
                       {"layer", place.layer},
                       {"small", all.bead.is_larger_than(place)},
                       {"worst", worst_of(place, all.bead)},
                       {"words", words_of(place, all, settings)}});
}

}  // namespace

Json to_record(const Verdict& verdict) {
  Json reasons = Json::array();
  for (const auto& [name, share, worst, at, words, rank] : verdict.broken)
    reasons.push_back(
        Json::object({{"name", name}, {"share", share}, {"worst", worst}, {"at", at}, {"words", words}}));
  return Json::object({{"buildable", verdict.buildable()},
                       {"class", name_of(verdict.build_class)},
                       {"words", verdict.words()},
                       {"reasons", reasons}});
}

Json to_record(const RealLayers& layers, const std::string& unit) {
  Json record = Json::object({{"passes", layers.passes},
                              {"count", layers.count},
                              {"elements", layers.elements},
                              {"elements_per_bead", layers.per_bead},
                              {"simulated", to_record(layers.simulated)},
                              {"words", words_of(layers)}});
  if (const auto& lumping = layers.lumping)
    record["lumping"] = Json::object({{"elements", lumping->elements},
                                      {"elements_per_bead", lumping->per_bead},
                                      {"simulated", to_record(lumping->simulated)},
                                      {"real", to_record(lumping->real)},
                                      {"planar_simulated", to_record(lumping->planar_simulated)},
                                      {"planar_real", to_record(lumping->planar_real)},
                                      {"words", words_of(*lumping, unit)}});
  return record;
}

Json to_record(const FaultyPlaces& places, const ModelSettings& settings) {
  Json record = Json::array();
  for (const Place& place : places.largest) record.push_back(to_record(place, places, settings));
  return record;
}

Json to_record(const Headline& headline) {
  Json record = Json::object({{"of", "skin"}, {"released", headline.released}, {"length", headline.length}});
  if (headline.alternative) record["baseline"] = to_record(*headline.alternative);
  record["planar"] = to_record(headline.planar);
  if (headline.start) record["start"] = to_record(*headline.start);
  if (headline.scaled)
    record["scaled_drawing"] =
        Json::object({{"factor", headline.scaled->factor}, {"length", headline.scaled->rms}});
  record["words"] = headline.words;
  return record;
}

Json to_record(const RepairReport& repair) {
  Json moved = Json::array();
  for (const auto& [element, from, to] : repair.changes.moved)
    moved.push_back(Json::object({{"element", element}, {"from", from}, {"to", to}}));
  return Json::object({{"repaired", repair.changes.repaired},
                       {"moved", moved},
                       {"before", Json::object({{"class", name_of(repair.build_class)},
                                                {"places_in_all", repair.places},
                                                {"rms", repair.rms},
                                                {"largest", repair.largest}})}});
}

Json answer_record(const Headline& headline, const FinalReports& reports, const ModelSettings& settings) {
  Json best, gain;
  if (const auto& found = headline.alternative) {
    gain = found->ratio;
    best = Json::object({{"block", found->block},
                         {"title", found->title},
                         {"class", name_of(found->build_class)},
                         {"rms", found->length},
                         {"largest", found->largest}});
  }
  return Json::object({{"class", name_of(headline.build_class)},
                       {"gain", gain},
                       {"best_alternative", best},
                       {"rms", headline.length},
                       {"largest", headline.largest},
                       {"unit", settings.unit},
                       {"released", headline.released},
                       {"places", to_record(*reports.binary.found.places, settings)},
                       {"repaired", reports.repair ? reports.repair->changes.repaired : 0}});
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

namespace {

Json to_records(const std::vector<TriedDirection>& directions) {
  Json result = Json::array();
  for (const auto& [direction, tilt, length, build_class] : directions)
    result.push_back(Json::object(
        {{"direction", direction}, {"tilt", tilt}, {"length", length}, {"class", name_of(build_class)}}));
  return result;
}

}  // namespace

void add_directions(Json& record, const Baseline& baseline) {
  if (baseline.direction.empty()) return;
  record["direction"] = baseline.direction;
  record["scan"] =
      Json::object({{"elements", baseline.tried_on}, {"directions", to_records(baseline.tried)}});
  if (!baseline.finalists.empty()) record["scan"]["finalists"] = to_records(baseline.finalists);
}

}  // namespace fabseq
