// SPDX-License-Identifier: MIT
/// Numbers of a sequence as JSON: the blocks of summary.json and evaluation.json.
#include "fabseq/run/sequence_report.h"

namespace fabseq {

namespace {

Json response_table(const std::vector<NamedValue>& responses) {
  Json table = Json::array();
  for (const auto& [name, type, value] : responses)
    table.push_back(Json::object({{"name", name}, {"type", type}, {"value", value}}));
  return table;
}

Json layer_table(const std::vector<LayerNumbers>& layers) {
  Json table = Json::array();
  for (const LayerNumbers& layer : layers) {
    Json entry =
        Json::object({{"volume", layer.volume}, {"thickness", layer.thickness}, {"cv", layer.variation}});
    if (layer.sub_part > 0) {
      entry["subpart"] = layer.sub_part;
      entry["slab"] = layer.slab;
    }
    table.push_back(entry);
  }
  return table;
}

}  // namespace

Json to_record(const DisplacementSize& size) {
  return Json::object({{"max", size.largest}, {"rms", size.rms}});
}

void add_members(Json& record, const SequenceNumbers& numbers) {
  record["responses"] = response_table(numbers.responses);
  record["layers"] = layer_table(numbers.layers);
  record["displacement"] = to_record(numbers.displacement_size);
}

Json to_record(const SequenceNumbers& numbers) {
  Json record = Json::object();
  add_members(record, numbers);
  return record;
}

}  // namespace fabseq
