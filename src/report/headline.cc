// SPDX-License-Identifier: MIT
#include "fabseq/report/headline.h"

#include "fabseq/base/formatted.h"

#include <algorithm>

namespace fabseq {

namespace {

/// Lengths that differ by less are alike.
constexpr double difference = 1.05;

/// How a length compares with one that is `ratio` times as long, which is named next.
std::string less_than(double ratio) {
  if (ratio > 1.0 / difference && ratio < difference) return "about as much as ";
  const auto times = [](double factor) { return formatted(factor < 9.95 ? "%.1f" : "%.0f", factor); };
  return ratio > 1.0 ? times(ratio) + " times less than " : times(1.0 / ratio) + " times more than ";
}

/// Puts the headline of one run together.
class HeadlineWriter {
 public:
  HeadlineWriter(const FinalReports& reports, const SequenceNumbers& planar, bool after_release,
                 const std::string& unit)
      : reports_(reports), planar_(planar), unit_(unit) {
    result_.released = after_release && reports.binary.finished->released && planar.finished->released;
    result_.length = deviation(reports.binary).skin.rms;
  }

  Headline write() {
    compare();
    add_comparison();
    add_lengths();
    add_largest();
    add_scaled_drawing();
    for (const LateSet& set : reports_.binary.late_sets) result_.words.push_back(set.words());
    return std::move(result_);
  }

 private:
  const Deviation& deviation(const SequenceNumbers& of) const {
    return of.finished->deviation(result_.released);
  }
  ComparedSequence compared(const std::string& block, const std::string& title,
                            const SequenceNumbers& with) const {
    const double length = deviation(with).skin.rms;
    return {block, title, length, result_.length > 0.0 ? length / result_.length : 1.0,
            with.verdict->buildable()};
  }

  /// Finds what to compare with, and which of these can be built.
  void compare() {
    const SequenceNumbers* best = nullptr;
    const auto offer = [&](const std::string& block, const std::string& title, const SequenceNumbers& with) {
      if (!with.verdict->buildable()) return;
      if (result_.baseline && result_.baseline->length <= deviation(with).skin.rms) return;
      result_.baseline = compared(block, title, with);
      best = &with;
    };
    offer("baseline", "planar", planar_);
    for (const Baseline& baseline : reports_.baselines)
      offer(baseline.block, baseline.title, baseline.numbers);
    if (result_.baseline)
      rivals_.push_back({*result_.baseline, *best});
    else
      result_.planar = compared("baseline", "planar", planar_);
    if (reports_.start) result_.start = compared("start", "start", *reports_.start);
    if (result_.start && result_.start->buildable) rivals_.push_back({*result_.start, *reports_.start});
  }

  void add_comparison() {
    std::string words = reports_.binary.verdict->buildable() ? "" : "not buildable: ";
    if (result_.baseline)
      words += "the skin distorts " + less_than(result_.baseline->ratio) +
               "in the best buildable baseline (" + result_.baseline->title + ")";
    else
      words += std::string(rivals_.empty() ? "no baseline" : "no baseline but the start") +
               " is buildable; the skin distorts " + less_than(result_.planar->ratio) + "in planar layers";
    if (result_.start)
      words += ", " + less_than(result_.start->ratio) + "in the start" +
               (result_.start->buildable ? "" : " (not buildable)");
    result_.words.push_back(words);
  }

  void add_lengths() {
    const ComparedSequence& other = result_.baseline ? *result_.baseline : *result_.planar;
    std::string words = std::string("skin, rms after the best rigid fit, ") +
                        (result_.released ? "after the release" : "as built") + ": optimized " +
                        length_words(result_.length, unit_) + ", " + other.title + " " +
                        length_words(other.length, unit_);
    if (result_.start) words += ", start " + length_words(result_.start->length, unit_);
    result_.words.push_back(words);
  }

  /// Says so where a smaller rms has been bought with a larger worst place.
  void add_largest() {
    const double largest = deviation(reports_.binary).skin.largest;
    std::string worse;
    for (const auto& [rival, numbers] : rivals_) {
      const double other = deviation(numbers).skin.largest;
      if (largest > difference * other) worse += ", " + rival.title + " " + length_words(other, unit_);
    }
    if (!worse.empty())
      result_.words.push_back("the largest displacement of the skin got worse: optimized " +
                              length_words(largest, unit_) + worse);
  }

  /// A drawing that is scaled costs nothing: whoever gains less from the sequence should take that. What
  /// cannot be built is no alternative.
  void add_scaled_drawing() {
    bool gains = true;
    for (const auto& [rival, numbers] : rivals_) {
      gains = gains && rival.ratio >= difference;
      const ScaledDrawing& scaled = deviation(numbers).scaled;
      if (scaled.rms < (result_.scaled ? result_.scaled->rms : result_.length)) result_.scaled = scaled;
    }
    if (gains && !result_.scaled) return;
    std::string words = gains ? "" : "there is nothing to gain from the sequence here";
    if (result_.scaled)
      words += std::string(gains ? "" : ", and ") + "a drawing that is scaled by " +
               formatted("%.5g", result_.scaled->factor) +
               " does more, without any optimized sequence: it leaves " +
               length_words(result_.scaled->rms, unit_) + " of the skin's rms";
    result_.words.push_back(words);
  }

  /// One that can be built: the best baseline, the start.
  struct Rival {
    ComparedSequence compared;
    const SequenceNumbers& numbers;
  };

  const FinalReports& reports_;
  const SequenceNumbers& planar_;
  std::string unit_;
  std::vector<Rival> rivals_;
  Headline result_;
};

}  // namespace

Headline make_headline(const FinalReports& reports, const SequenceNumbers& planar, bool after_release,
                       const std::string& unit) {
  return HeadlineWriter(reports, planar, after_release, unit).write();
}

}  // namespace fabseq
