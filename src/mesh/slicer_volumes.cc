// SPDX-License-Identifier: MIT
#include "mesh/slicer_volumes.h"

#include "fabseq/base/error.h"
#include "fabseq/base/plain_numbers.h"
#include "mesh/archived_xml.h"
#include "mesh/text_values.h"
#include "mesh/zip_archive.h"

#include <optional>
#include <string_view>

namespace fabseq {

namespace {

/// Slicers look for these names whatever their case. Of the first three, the first that is there counts, as
/// in SuperSlicer, which writes some of them with the same content.
constexpr std::string_view files_of_ranges[] = {
    "metadata/slic3r_model.config", "metadata/superslicer_model.config", "metadata/slic3r_pe_model.config"};
constexpr std::string_view file_of_parts = "metadata/model_settings.config";

/// A type that no slicer of the family had at the time of writing is taken for a helper, as all later ones
/// have been.
VolumeUse use_of(std::string_view type) {
  static constexpr std::pair<std::string_view, const char*> helpers[] = {
      {"ParameterModifier", "modifier"},
      {"modifier_part", "modifier"},
      {"1", "modifier"},
      {"SupportEnforcer", "support enforcer"},
      {"support_enforcer", "support enforcer"},
      {"SupportBlocker", "support blocker"},
      {"support_blocker", "support blocker"}};
  if (type.empty() || type == "ModelPart" || type == "normal_part" || type == "0") return {};
  if (type == "NegativeVolume" || type == "negative_part") return {.kind = VolumeUse::negative};
  for (const auto& [known, name] : helpers)
    if (type == known) return {VolumeUse::helper, name, std::string(name) + "s"};
  const std::string of_type = " of type \"" + std::string(type.substr(0, 40)) + '"';
  return {VolumeUse::helper, "volume" + of_type, "volumes" + of_type};
}

std::int64_t number_of(std::string_view text) {
  const auto number = number_in<std::int64_t>(text);
  if (!number || *number < 0)
    throw InputError("has the number \"" + std::string(text.substr(0, 40)) +
                     "\" of a triangle, needs one from 0 on");
  return *number;
}

/// Takes the elements of one of the files one after the other.
class Reader {
 public:
  explicit Reader(SlicerVolumes& result) : result_(result) {}

  void take(std::string_view element, const XmlAttributes& attributes) {
    if (element == "object") {
      object_ = attributes["id"];
      use_ = nullptr;
    } else if (element == "volume") {
      auto& ranges = result_.ranges[object_];
      ranges.push_back({number_of(attributes["firstid"]), number_of(attributes["lastid"]), {}});
      use_ = &ranges.back().use;
    } else if (element == "part") {
      auto& parts = result_.parts[object_];
      parts.push_back({std::string(attributes["id"]), use_of(attributes["subtype"])});
      use_ = &parts.back().use;
    } else if (element == "plate") {
      use_ = nullptr;
    } else if (element == "metadata" && use_ != nullptr) {
      take_metadata(attributes["key"], attributes["value"]);
    }
  }

 private:
  void take_metadata(std::string_view key, std::string_view value) {
    if (key == "modifier" && value == "1") *use_ = use_of("ParameterModifier");
    if (key == "volume_type" || key == "part_type") *use_ = use_of(value);
  }

  SlicerVolumes& result_;
  std::string object_;
  VolumeUse* use_ = nullptr;  ///< of the volume in hand
};

std::optional<std::string> file_called(const ZipArchive& archive, std::string_view wanted) {
  for (const std::string& name : archive.names())
    if (lower_case(name) == wanted) return name;
  return std::nullopt;
}

void read(const ZipArchive& archive, const std::string& file, SlicerVolumes& result) {
  Reader reader(result);
  for_each_archived_element(archive, file, [&](std::string_view element, const XmlAttributes& attributes) {
    reader.take(element, attributes);
  });
}

}  // namespace

SlicerVolumes read_slicer_volumes(const ZipArchive& archive) {
  SlicerVolumes result;
  for (const std::string_view name : files_of_ranges)
    if (const auto file = file_called(archive, name)) {
      read(archive, *file, result);
      break;
    }
  if (const auto file = file_called(archive, file_of_parts)) read(archive, *file, result);
  return result;
}

}  // namespace fabseq
