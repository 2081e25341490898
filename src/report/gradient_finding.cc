// SPDX-License-Identifier: MIT
/// \file
/// What the checks of direction and thickness go by.
#include "fabseq/base/mpi.h"
#include "fabseq/report/finding.h"
#include "fabseq/report/verdict.h"

namespace fabseq {

namespace {

/// Share of the part: more is no meeting of fronts.
constexpr double most_elsewhere = 0.25;

std::string name_of(GradientSource source) {
  switch (source) {
    case GradientSource::file:
      return "file";
    case GradientSource::differences:
      return "differences";
    case GradientSource::layer_differences:
      return "layer_differences";
    default:
      return "sequence";
  }
}

class GradientNumbers : public FoundNumbers {
 public:
  explicit GradientNumbers(const TimeGradient& gradient)
      : source_(gradient.source), elsewhere_(gradient.share_elsewhere) {}

  template <int Dim>
  static std::optional<GradientNumbers> measure(const MeasuredSequence<Dim>& sequence, BuildFields& fields) {
    if (any(sequence.part().grid().comm(), !sequence.direction.empty()))
      fields.add({"build_direction", sequence.direction, Dim});
    return GradientNumbers(sequence.gradient);
  }

  void add_record(Json& block) const override { block["checks"]["gradient"] = name_of(source_); }

  /// Says what the checks of a sequence without a gradient of its own go by.
  std::vector<std::string> words() const override {
    const std::string begin = "checks of direction and thickness: ";
    switch (source_) {
      case GradientSource::file:
        return {begin + "by the gradient recorded beside the times"};
      case GradientSource::differences:
        return {begin + "by differences of the elements' times, which come without a gradient"};
      case GradientSource::layer_differences:
        return {begin + "estimates, by differences of times that are no finer than layers"};
      default:
        return {};
    }
  }
  ToldIn told_in() const override { return ToldIn::table; }

  std::vector<std::string> doubts() const override {
    if (elsewhere_ <= most_elsewhere) return {};
    return {"/sequence/file: the gradient recorded beside the times points elsewhere than these grow at " +
            percent_words(elsewhere_) + " of the part: it seems to belong to other times"};
  }

 private:
  GradientSource source_;
  double elsewhere_;
};

const RegisteredFinding<GradientNumbers> registered_gradient({"gradient", 10, MeasuredIn::checks});

}  // namespace

}  // namespace fabseq
