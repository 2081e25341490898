// SPDX-License-Identifier: MIT
/// \file
/// How thick the layers are at each element.
#include "fabseq/base/formatted.h"
#include "fabseq/machine/local_thickness.h"
#include "fabseq/machine/meeting_fronts.h"
#include "fabseq/report/build_report.h"
#include "fabseq/report/verdict.h"
#include "report/broken_limit.h"
#include "report/elements_words.h"
#include "report/marks_record.h"

#include <cmath>

namespace fabseq {

namespace {

class ThicknessNumbers : public FoundNumbers {
 public:
  explicit ThicknessNumbers(const ModelSettings& settings) : unit_(settings.unit) {
    if (settings.layers.target) target_ = settings.layers.target->value;
  }

  template <int Dim>
  static std::optional<ThicknessNumbers> measure(const MeasuredSequence<Dim>& sequence, BuildFields& fields) {
    ThicknessNumbers result(sequence.settings());
    const Part<Dim>& part = sequence.part();
    std::vector<double> thickness =
        local_thickness<Dim>(sequence.time.time, sequence.gradient.values, sequence.layers,
                             sequence.layer_index, part.longest_edge());
    result.range_ = thickness_range<Dim>(
        part, thickness, sequence.gradient.values,
        meeting_fronts<Dim>(part, sequence.time.time, sequence.gradient.values),
        allowed_thickness(sequence.settings()), sequence.layer_index, sequence.layers.count());
    if (result.range_) fields.add({"local_thickness", std::move(thickness)});
    return result;
  }

  void add_record(Json& block) const override {
    Json& record = block["checks"]["local_thickness"];
    if (!range_) return;
    record = Json::object({{"least", range_->least},
                           {"largest", range_->largest},
                           {"largest_at", range_->largest_at},
                           {"largest_is_meeting", range_->largest_is_meeting},
                           {"without_end", range_->without_end.elements},
                           {"share_outside", Json()}});
    if (const auto& outside = range_->outside) {
      record["share_outside"] = outside->share;
      record["worst"] = range_->worst;
      record["at"] = place_record(*outside);
      record["per_layer"] = outside->per_layer;
    }
  }

  /// "0.53 to 1.4"
  std::vector<TableCell> cells(const Found& /*all*/) const override {
    if (!range_) return {};
    return {{40, "thickness",
             formatted("%.2g to ", range_->least) +
                 (range_->largest_is_meeting ? "(fronts meet)" : formatted("%.2g", range_->largest))}};
  }

  std::optional<BrokenLimit> broken_limit() const override {
    if (!range_ || !range_->outside) return std::nullopt;
    const double times = range_->worst / target_;
    // Where the gradient of the time vanishes, the figure means nothing.
    const std::string worst = times < 100.0 ? formatted("worst %.2g times the target ", times) : "worst ";
    const bool is_meeting = range_->largest_is_meeting && range_->worst == range_->largest;
    return limit_broken_at(*range_->outside, {.name = "local_thickness", .worst = times, .rank = 10},
                           "is out of thickness", worst + (is_meeting ? "where fronts meet " : ""));
  }

  /// A meeting of fronts is no thick layer.
  std::vector<std::string> words() const override {
    std::vector<std::string> result = FoundNumbers::words();
    if (result.empty()) return result;
    result.push_back(
        "the largest local thickness is " +
        (std::isfinite(range_->largest) ? length_words(range_->largest, unit_) : "beyond all bounds") + " " +
        near_words(range_->largest_at) + ": " +
        (range_->largest_is_meeting ? "fronts meet there and the gradient of the time vanishes, "
                                      "so it is no thick layer"
                                    : "a thick layer"));
    return result;
  }

  std::vector<std::string> doubts() const override {
    if (!range_ || range_->without_end.elements == 0) return {};
    return {"local thickness: the pseudo-time hardly changes at " +
            elements_words(range_->without_end, "first") +
            ", whose layers count as thick as the part is long"};
  }

 private:
  std::optional<ThicknessRange> range_;  ///< none where it is not defined
  double target_ = 0.0;                  ///< of the layers; 0: none
  std::string unit_;
};

const RegisteredFinding<ThicknessNumbers> registered_thickness({"local_thickness", 40, MeasuredIn::checks});

}  // namespace

}  // namespace fabseq
