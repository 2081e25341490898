// SPDX-License-Identifier: MIT
/// \file
/// What is concluded from the end of an optimization, as JSON (docs/reference.md, summary.json).
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/report/headline.h"

#include <string>

namespace fabseq {

Json to_record(const Verdict& verdict);
/// The block "real_layers". `unit`: of length.
Json to_record(const RealLayers& layers, const std::string& unit);
Json to_record(const Headline& headline);
/// Places with what is wrong there, the largest first.
Json to_record(const FaultyPlaces& places, const ModelSettings& settings);
/// What programs read first: class, gain, the best alternative, places.
Json answer_record(const Headline& headline, const FinalReports& reports, const ModelSettings& settings);
/// A constraint with its bounds: sign * (value - bound) / scale of none of its values may be above 0.
Json to_record(const ConstraintLimit& limit);
/// What only a baseline has: the direction of tilted layers, and all that were tried.
void add_directions(Json& record, const Baseline& baseline);

}  // namespace fabseq
