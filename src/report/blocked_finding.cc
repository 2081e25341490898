// SPDX-License-Identifier: MIT
/// \file
/// Elements that the torch cannot reach, because it would run into deposited material.
#include "fabseq/base/mpi.h"
#include "fabseq/machine/blocked.h"
#include "fabseq/machine/torch.h"
#include "fabseq/report/finding.h"
#include "fabseq/report/verdict.h"
#include "report/broken_limit.h"
#include "report/marks_record.h"

namespace fabseq {

namespace {

class BlockedNumbers : public FoundNumbers {
 public:
  explicit BlockedNumbers(std::string unit) : unit_(std::move(unit)) {}

  template <int Dim>
  static std::optional<BlockedNumbers> measure(const MeasuredSequence<Dim>& sequence, BuildFields& fields) {
    BlockedNumbers result(sequence.settings().unit);
    const ToolSettings& tool = sequence.settings().tool;
    if (tool.profile.empty() || !any(sequence.part().grid().comm(), !sequence.axis.empty())) return result;
    std::vector<double> depth =
        blocked_depth<Dim>(sequence.part(), Torch(tool), sequence.axis, sequence.layer_index);
    result.marked_ = sequence.count(depth, MarkedPlace::largest);
    fields.add({"blocked", std::move(depth)});
    return result;
  }

  void add_record(Json& block) const override {
    Json& record = block["checks"]["blocked"];
    if (!marked_) return;
    record = Json::object({{"elements", marked_->elements},
                           {"share", marked_->share},
                           {"deepest", marked_->largest},
                           {"at", place_record(*marked_)},
                           {"per_layer", marked_->per_layer}});
  }

  std::optional<BrokenLimit> broken_limit() const override {
    if (!marked_) return std::nullopt;
    return limit_broken_at(*marked_, {.name = "blocked", .worst = marked_->largest, .rank = 30},
                           "is out of the torch's reach",
                           "by " + length_words(marked_->largest, unit_) + " ");
  }

 private:
  std::optional<MarkedElements> marked_;  ///< by how deep the torch is blocked; none without a torch
  std::string unit_;
};

const RegisteredFinding<BlockedNumbers> registered_blocked({"blocked", 20, MeasuredIn::checks});

}  // namespace

}  // namespace fabseq
