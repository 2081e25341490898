// SPDX-License-Identifier: MIT
/// \file
/// What a sequence's heat amounts to (docs/formulation.md 14.2).
#pragma once

#include "fabseq/report/found_numbers.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// A temperature at which a layer begins.
struct LayerTemperature {
  double value = 0.0;      ///< degrees Celsius
  int layer = 0;           ///< that begins, from 1
  std::vector<double> at;  ///< centre of the element, length unit; empty: of a whole layer
};

/// The pauses that keep an interpass temperature, and the build time with them.
struct PauseNumbers {
  std::vector<std::optional<double>> seconds;  ///< after each real layer, [layer]; none: no pause is enough
  std::optional<double> hours;                 ///< none where a pause is missing
};

/// Figures of a sequence, the same on all ranks.
struct TemperatureNumbers : FoundNumbers {
  void add_record(Json& block) const override;
  std::vector<TableCell> cells(const Found& all) const override;

  LayerTemperature highest;            ///< the highest of the interpass temperatures
  LayerTemperature hottest;            ///< the hottest element that stands when a layer begins
  std::optional<PauseNumbers> pauses;  ///< where the config has an interpass limit; of full reports
};

}  // namespace fabseq
