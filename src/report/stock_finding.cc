// SPDX-License-Identifier: MIT
/// \file
/// Machining stock that the config has added to the part.
#include "fabseq/report/finding.h"
#include "fabseq/report/verdict.h"

namespace fabseq {

namespace {

class StockNumbers : public FoundNumbers {
 public:
  explicit StockNumbers(double share) : share_(share) {}

  template <int Dim>
  static std::optional<StockNumbers> measure(const MeasuredSequence<Dim>& sequence, BuildFields& /*fields*/) {
    const double share = sequence.part().share_of_stock();
    return share > 0.0 ? std::optional(StockNumbers(share)) : std::nullopt;
  }

  void add_record(Json& block) const override { block["stock"] = share_; }
  std::vector<std::string> words() const override {
    return {percent_words(share_) + " of the part is machining stock, to be machined away (stock)"};
  }
  ToldIn told_in() const override { return ToldIn::headline; }

 private:
  double share_;  ///< of the part
};

const RegisteredFinding<StockNumbers> registered_stock({"stock", 80, MeasuredIn::reports});

}  // namespace

}  // namespace fabseq
