// SPDX-License-Identifier: MIT
#include "fabseq/report/build_class.h"

#include "fabseq/base/formatted.h"
#include "fabseq/report/verdict.h"

#include <array>

namespace fabseq {

namespace {

/// "12 x 3 x 3 mm"
std::string size_words(const Place& place, const std::string& unit) {
  std::string text;
  for (const double extent : place.extent) text += (text.empty() ? "" : " x ") + formatted("%.3g", extent);
  return text + (unit.empty() ? "" : " " + unit);
}

std::string advice(PlaceForm form) {
  switch (form) {
    case PlaceForm::roof:
      return "close it (stock; new --fill-holes) and drill";
    case PlaceForm::island:
      return "weld a seed there, or turn the part";
    default:
      return "turn the part, or let the table tilt further";
  }
}

}  // namespace

BuildClass class_without(const FaultyPlaces& places, const std::vector<bool>& left_out,
                         const ToolSettings& tool) {
  std::int64_t count = places.in_all;
  double begins = places.begins;
  bool small = true;
  for (std::size_t i = 0; i < places.largest.size(); ++i) {
    const Place& place = places.largest[i];
    if (i < left_out.size() && left_out[i]) {
      --count;
      begins -= place.begins;
    } else {
      small &= places.bead.is_larger_than(place);
    }
  }
  if (count == 0) return BuildClass::buildable;
  // Who is not told of all places has more of them than can be few.
  return small && count <= tool.most_places && begins <= tool.places_share * places.part_volume
             ? BuildClass::buildable_but_for_places
             : BuildClass::not_buildable;
}

BuildClass class_of(const FaultyPlaces& places, const ToolSettings& tool) {
  return class_without(places, {}, tool);
}

std::string name_of(BuildClass build_class) {
  constexpr std::array names = {"buildable", "buildable_but_for_places", "not_buildable"};
  return names[static_cast<std::size_t>(build_class)];
}

std::string words_of(BuildClass build_class, std::int64_t places) {
  if (build_class == BuildClass::buildable) return "buildable";
  if (build_class == BuildClass::not_buildable) return "not buildable";
  return "buildable but for " + std::to_string(places) + (places == 1 ? " place" : " places");
}

std::string name_of(Fault fault) {
  constexpr std::array names = {"", "hanging", "local_thickness", "tilt", "blocked"};
  return names[static_cast<std::size_t>(fault)];
}

std::string name_of(PlaceForm form) {
  constexpr std::array names = {"", "roof", "island", "overhang", "thin", "thick"};
  return names[static_cast<std::size_t>(form)];
}

std::string words_of(const Place& place, const FaultyPlaces& all, const ModelSettings& settings) {
  const std::string where = " of " + size_words(place, settings.unit) + " " + near_words(place.centre);
  const std::string layer = " in layer " + std::to_string(place.layer);
  switch (place.fault) {
    case Fault::hanging: {
      const double on_it = place.begins / place.volume;
      const std::string carried =
          on_it < 1.5 ? ""
                      : formatted(", with %.2g %% of the part on it", 100.0 * place.begins / all.part_volume);
      return (place.form == PlaceForm::roof ? "a " : "an ") + name_of(place.form) + where +
             " begins in the air" + layer + carried + ": " + advice(place.form);
    }
    case Fault::local_thickness: {
      const double times = place.worst / all.bead.height;
      const std::string range =
          formatted(", allowed are %.3g to %.3g", settings.tool.thickness[0], settings.tool.thickness[1]);
      return "a bead" + where +
             (times < 100.0 ? formatted(" is %.3g times as thick as the target", times)
                            : " is far too thick") +
             layer + range;
    }
    case Fault::tilt:
      return "the torch tilts by " + formatted("%.3g of %.3g degrees", place.worst, settings.tool.max_tilt) +
             " at a place" + where + layer;
    default:
      return "the torch lacks " + length_words(place.worst, settings.unit) + " of room at a place" + where +
             layer;
  }
}

}  // namespace fabseq
