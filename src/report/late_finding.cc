// SPDX-License-Identifier: MIT
/// \file
/// Elements that are later than the last layer, of curved layers.
#include "fabseq/base/formatted.h"
#include "fabseq/report/finding.h"
#include "report/elements_words.h"
#include "report/marks_record.h"

namespace fabseq {

namespace {

/// Elements whose time is beyond the last layer's by more than this, in layers, count as late.
constexpr double late_from = 0.25;

class LateNumbers : public FoundNumbers {
 public:
  template <int Dim>
  static std::optional<LateNumbers> measure(const MeasuredSequence<Dim>& sequence, BuildFields& /*fields*/) {
    LateNumbers result;
    const std::vector<double>& time_points = sequence.layers.time_points;
    if (time_points.empty()) return result;
    std::vector<double> late;
    for (const double time : sequence.time.time)
      late.push_back(sequence.layers.count() * (time - time_points.back()) - late_from);
    result.marked_ = sequence.count(late, MarkedPlace::largest);
    return result;
  }

  void add_record(Json& block) const override {
    block["checks"]["late"] = marked_ ? marks_record(*marked_) : Json();
  }

  std::vector<std::string> doubts() const override {
    if (!marked_ || marked_->elements == 0) return {};
    return {"/layers/count: the last layer also holds what comes later, " +
            elements_words(*marked_, "latest") +
            formatted(": it is up to %.2g times as thick as its pseudo-time says; more layers, or thicker "
                      "ones, reach the part's end",
                      marked_->largest + late_from + 1.0)};
  }

 private:
  std::optional<MarkedElements> marked_;  ///< by how many layers beyond late_from; none: not curved layers
};

const RegisteredFinding<LateNumbers> registered_late({"late", 50, MeasuredIn::checks});

}  // namespace

}  // namespace fabseq
