// SPDX-License-Identifier: MIT
/// \file
/// How far the torch tilts from the plate's normal.
#include "fabseq/base/formatted.h"
#include "fabseq/base/mpi.h"
#include "fabseq/machine/torch.h"
#include "fabseq/report/build_report.h"
#include "report/broken_limit.h"
#include "report/marks_record.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Degrees: from here on tool.max_tilt is no limit.
constexpr double any_tilt = 180.0;

class TiltNumbers : public FoundNumbers {
 public:
  explicit TiltNumbers(double limit) : limit_(limit) {}

  template <int Dim>
  static std::optional<TiltNumbers> measure(const MeasuredSequence<Dim>& sequence, BuildFields& fields) {
    TiltNumbers result(sequence.settings().tool.max_tilt);
    const MPI_Comm comm = sequence.part().grid().comm();
    if (!any(comm, !sequence.axis.empty())) return result;
    std::vector<double> tilt = torch_tilt<Dim>(sequence.part(), sequence.axis);
    double largest = 0.0;
    for (const double angle : tilt) largest = std::max(largest, angle);
    result.largest_ = max(comm, largest);
    fields.add({"tilt", std::move(tilt)});
    result.beyond_ =
        sequence.count(*fault_marks(fields, sequence.settings(), Fault::tilt), MarkedPlace::largest);
    return result;
  }

  void add_record(Json& block) const override {
    Json& record = block["checks"]["tilt"];
    if (!largest_) return;
    record = Json::object({{"largest", *largest_},
                           {"beyond", beyond_.elements},
                           {"share", beyond_.share},
                           {"at", place_record(beyond_)},
                           {"per_layer", beyond_.per_layer}});
  }

  std::vector<TableCell> cells(const Found& /*all*/) const override {
    return {
        {20, limit_ < any_tilt ? "tilt" : "tilt (no limit)", largest_ ? formatted("%.0f", *largest_) : "-"}};
  }

  std::optional<BrokenLimit> broken_limit() const override {
    if (!largest_) return std::nullopt;
    return limit_broken_at(beyond_, {.name = "tilt", .worst = *largest_, .rank = 20},
                           "is tilted beyond the limit",
                           formatted("%.3g of %.3g degrees ", *largest_, limit_));
  }

 private:
  double limit_;                   ///< tool.max_tilt, degrees
  std::optional<double> largest_;  ///< degrees; none where the torch's axis is not defined
  MarkedElements beyond_;          ///< by how much it is beyond the limit
};

const RegisteredFinding<TiltNumbers> registered_tilt({"tilt", 30, MeasuredIn::checks});

}  // namespace

}  // namespace fabseq
