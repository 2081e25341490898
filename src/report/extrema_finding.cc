// SPDX-License-Identifier: MIT
/// \file
/// Elements that are earlier, or later, than all around them.
#include "fabseq/machine/interior_extrema.h"
#include "fabseq/report/finding.h"
#include "report/marks_record.h"

namespace fabseq {

namespace {

class ExtremaNumbers : public FoundNumbers {
 public:
  ExtremaNumbers(MarkedElements minima, MarkedElements maxima)
      : minima_(std::move(minima)), maxima_(std::move(maxima)) {}

  template <int Dim>
  static std::optional<ExtremaNumbers> measure(const MeasuredSequence<Dim>& sequence,
                                               BuildFields& /*fields*/) {
    const InteriorExtrema extrema = find_interior_extrema<Dim>(sequence.part(), sequence.time.time);
    return ExtremaNumbers(sequence.count(extrema.minima, MarkedPlace::earliest),
                          sequence.count(extrema.maxima, MarkedPlace::earliest));
  }

  void add_record(Json& block) const override {
    block["checks"]["interior_minima"] = marks_record(minima_);
    block["checks"]["interior_maxima"] = marks_record(maxima_);
  }

 private:
  MarkedElements minima_, maxima_;
};

const RegisteredFinding<ExtremaNumbers> registered_extrema({"interior_extrema", 70, MeasuredIn::checks});

}  // namespace

}  // namespace fabseq
