// SPDX-License-Identifier: MIT
/// \file
/// Node sets of the objective that the last layers build, where material goes to nominal positions.
#include "fabseq/report/finding.h"
#include "fabseq/report/late_sets.h"

namespace fabseq {

namespace {

class LateSetNumbers : public FoundNumbers {
 public:
  explicit LateSetNumbers(std::vector<LateSet> sets) : sets_(std::move(sets)) {}

  template <int Dim>
  static std::optional<LateSetNumbers> measure(const MeasuredSequence<Dim>& sequence,
                                               BuildFields& /*fields*/) {
    if (sequence.settings().process.deposition != DepositionModel::nominal) return std::nullopt;
    return LateSetNumbers(late_sets(sequence.part(), sequence.model.node_sets, sequence.settings().objective,
                                    sequence.layer_index));
  }

  /// Words alone.
  void add_record(Json& /*block*/) const override {}
  std::vector<std::string> words() const override {
    std::vector<std::string> result;
    for (const LateSet& set : sets_) result.push_back(set.words());
    return result;
  }
  ToldIn told_in() const override { return ToldIn::headline; }

 private:
  std::vector<LateSet> sets_;
};

const RegisteredFinding<LateSetNumbers> registered_late_sets({"late_sets", 120, MeasuredIn::reports});

}  // namespace

}  // namespace fabseq
