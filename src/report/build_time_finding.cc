// SPDX-License-Identifier: MIT
/// \file
/// Wire and time that a part takes: welding at the deposition rate, and a pause after each real layer.
#include "fabseq/base/formatted.h"
#include "fabseq/report/finding.h"
#include "report/temperature_numbers.h"

namespace fabseq {

namespace {

class BuildTimeNumbers : public FoundNumbers {
 public:
  template <int Dim>
  static std::optional<BuildTimeNumbers> measure(const MeasuredSequence<Dim>& sequence,
                                                 BuildFields& /*fields*/) {
    BuildTimeNumbers result;
    const ModelSettings& settings = sequence.settings();
    if (!settings.material.mass_density) return result;
    const double volume = sequence.part().volume();
    result.wire_ = *settings.material.mass_density * volume;
    if (const auto clock = settings.clock()) result.hours_ = clock->hours(volume, sequence.used_layers);
    return result;
  }

  void add_record(Json& block) const override {
    if (wire_) block["wire_mass"] = *wire_;
    if (hours_) block["build_hours"] = *hours_;
  }

  /// Returns the hours with the pauses that keep the interpass temperature, where they are known.
  std::vector<TableCell> cells(const Found& all) const override {
    const auto* heat = all.find<TemperatureNumbers>();
    const std::optional<double> hours = heat && heat->pauses ? heat->pauses->hours : hours_;
    return {{10, "hours", hours ? formatted("%.3g", *hours) : "-"}};
  }

 private:
  std::optional<double> wire_, hours_;  ///< kg; none without density and deposition rate
};

const RegisteredFinding<BuildTimeNumbers> registered_build_time({"build_time", 90, MeasuredIn::reports});

}  // namespace

}  // namespace fabseq
