// SPDX-License-Identifier: MIT
/// \file
/// How much is wrong with a sequence: nothing, a few places smaller than a bead, or more (docs/formulation.md
/// 13.4).
#pragma once

#include "fabseq/machine/tool_settings.h"
#include "fabseq/report/build_report.h"

#include <cstdint>
#include <string>
#include <vector>

namespace fabseq {

/// The better one is the smaller one.
enum class BuildClass { buildable, buildable_but_for_places, not_buildable };

/// The class of a sequence whose checks fail at these places alone. Not collective.
BuildClass class_of(const FaultyPlaces& places, const ToolSettings& tool);
/// The same without some of them, given by their index in `places.largest`.
BuildClass class_without(const FaultyPlaces& places, const std::vector<bool>& left_out,
                         const ToolSettings& tool);

/// Names a class as summary.json has it: "buildable_but_for_places".
std::string name_of(BuildClass build_class);
/// Names a class as people have it: "buildable but for 2 places".
std::string words_of(BuildClass build_class, std::int64_t places);

/// Names a fault or a form as summary.json has it: "local_thickness"; "roof", or "" without a form.
std::string name_of(Fault fault);
std::string name_of(PlaceForm form);
/// What is wrong at a place, and what to do about it: "a roof of 12 x 3 x 3 mm near [1,2,3] begins in the air
/// in layer 7: close it and drill".
std::string words_of(const Place& place, const FaultyPlaces& all, const ModelSettings& settings);

}  // namespace fabseq
