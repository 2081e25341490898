// SPDX-License-Identifier: MIT
/// \file
/// Elements that begin in the air.
#include "fabseq/machine/hanging.h"
#include "fabseq/report/finding.h"
#include "report/broken_limit.h"
#include "report/marks_record.h"

namespace fabseq {

namespace {

class HangingNumbers : public FoundNumbers {
 public:
  explicit HangingNumbers(MarkedElements marked) : marked_(std::move(marked)) {}

  template <int Dim>
  static std::optional<HangingNumbers> measure(const MeasuredSequence<Dim>& sequence, BuildFields& fields) {
    std::vector<double> hanging = hanging_elements<Dim>(
        sequence.part(), sequence.direction, sequence.layer_index, sequence.settings().tool.bead_width);
    HangingNumbers result(sequence.count(hanging, MarkedPlace::earliest));
    fields.add({"hanging", std::move(hanging)});
    return result;
  }

  void add_record(Json& block) const override { block["checks"]["hanging"] = marks_record(marked_); }

  std::optional<BrokenLimit> broken_limit() const override {
    return limit_broken_at(marked_,
                           {.name = "hanging", .worst = static_cast<double>(marked_.elements), .rank = 40},
                           "begins in the air", "first ");
  }

 private:
  MarkedElements marked_;
};

const RegisteredFinding<HangingNumbers> registered_hanging({"hanging", 60, MeasuredIn::checks});

}  // namespace

}  // namespace fabseq
