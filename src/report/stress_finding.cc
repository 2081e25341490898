// SPDX-License-Identifier: MIT
/// \file
/// Residual stress of the part as built, on the plate, where the config has a yield stress.
#include "fabseq/base/formatted.h"
#include "fabseq/process/residual_stress.h"
#include "fabseq/report/finding.h"

namespace fabseq {

namespace {

class StressNumbers : public FoundNumbers {
 public:
  StressNumbers(double von_mises, double share, double yield, bool flows)
      : von_mises_(von_mises), share_beyond_yield_(share), yield_(yield), flows_(flows) {}

  template <int Dim>
  static std::optional<StressNumbers> measure(const MeasuredSequence<Dim>& sequence, BuildFields& fields) {
    const auto yield = sequence.settings().material.yield_stress;
    if (!yield) return std::nullopt;
    const Part<Dim>& part = sequence.part();
    const std::vector<double> stress =
        sequence.pipeline->process().locked_in(*sequence.state->densities).stress;
    fields.add({"von_mises", equivalent_stress(part, stress), 1, /*with_binary=*/true});
    return StressNumbers(stress_extremes(part, stress).von_mises, share_beyond(part, stress, *yield), *yield,
                         sequence.settings().process.model == ProcessModel::elastoplastic);
  }

  void add_record(Json& block) const override {
    block["stress"] = Json::object({{"von_mises", von_mises_}, {"share_beyond_yield", share_beyond_yield_}});
  }

  /// No warning: with measured strains of steel it is nearly everywhere.
  std::vector<std::string> words() const override {
    const std::string up_to =
        formatted("residual stress, %s plastic flow: up to %.4g, ", flows_ ? "with" : "without", von_mises_);
    if (share_beyond_yield_ == 0.0) return {up_to + formatted("nowhere above the yield stress %.4g", yield_)};
    return {up_to + formatted("above the yield stress %.4g in %.3g %% of the part", yield_,
                              100.0 * share_beyond_yield_)};
  }

 private:
  double von_mises_;           ///< largest equivalent stress, stress unit
  double share_beyond_yield_;  ///< of the part's volume
  double yield_;               ///< stress unit
  bool flows_;                 ///< whether the material flows beyond it
};

const RegisteredFinding<StressNumbers> registered_stress({"stress", 100, MeasuredIn::reports});

}  // namespace

}  // namespace fabseq
