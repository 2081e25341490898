// SPDX-License-Identifier: MIT
#include "fabseq/report/headline.h"

#include "fabseq/base/formatted.h"
#include "fabseq/responses/response_type.h"
#include "report/shared_places.h"

#include <utility>

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
  HeadlineWriter(const FinalReports& reports, const SequenceNumbers& planar, const ModelSettings& settings)
      : reports_(reports), planar_(planar), settings_(settings) {
    result_.released = any_measures_release(settings.objective) && reports.binary.finished->released &&
                       planar.finished->released;
    result_.length = deviation(reports.binary).skin.rms;
    result_.largest = deviation(reports.binary).skin.largest;
    result_.build_class = reports.binary.verdict->build_class;
    sequences_ = {&reports.binary, &planar};
    for (const Baseline& baseline : reports.baselines) sequences_.push_back(&baseline.numbers);
  }

  Headline write() {
    compare();
    add_comparison();
    add_largest();
    add_scaled_drawing();
    for (std::string& words : reports_.binary.found.words_in(ToldIn::headline))
      result_.words.push_back(std::move(words));
    add_places();
    return std::move(result_);
  }

 private:
  const Deviation& deviation(const SequenceNumbers& of) const {
    return of.finished->deviation(result_.released);
  }
  ComparedSequence compared(const std::string& block, const std::string& title,
                            const SequenceNumbers& with) const {
    const DisplacementSize& skin = deviation(with).skin;
    return {block,
            title,
            skin.rms,
            skin.largest,
            result_.length > 0.0 ? skin.rms / result_.length : 1.0,
            with.verdict->class_words(),
            with.verdict->build_class};
  }
  BuildClass class_of(const SequenceNumbers& sequence) const {
    return class_beside(sequence, sequences_, settings_.tool);
  }

  /// Finds what to compare with: what is of the same class or a better one.
  void compare() {
    const BuildClass own = class_of(reports_.binary);
    const SequenceNumbers* best = nullptr;
    const auto offer = [&](const std::string& block, const std::string& title, const SequenceNumbers& with) {
      if (class_of(with) > own) return;
      if (result_.alternative && result_.alternative->length <= deviation(with).skin.rms) return;
      result_.alternative = compared(block, title, with);
      best = &with;
    };
    result_.planar = compared("baseline", "planar", planar_);
    offer("baseline", "planar", planar_);
    for (const Baseline& baseline : reports_.baselines)
      offer(baseline.block, baseline.title, baseline.numbers);
    if (result_.alternative) rivals_.push_back({*result_.alternative, *best});
    if (!reports_.start) return;
    result_.start = compared("start", "start", *reports_.start);
    if (class_of(*reports_.start) <= own) rivals_.push_back({*result_.start, *reports_.start});
  }

  void add_comparison() {
    std::string words = reports_.binary.verdict->class_words() + ": ";
    if (const auto& best = result_.alternative)
      words += "the skin distorts " + less_than(best->ratio) + "in the best alternative (" + best->title +
               ", " + best->class_words + ")";
    else
      words += "no baseline is of this class; the skin distorts " + less_than(result_.planar.ratio) +
               "in planar layers (" + result_.planar.class_words + ")";
    if (!rivals_.empty() && rivals_.back().compared.block == "start")
      words += ", " + less_than(result_.start->ratio) + "in the start";
    result_.words.push_back(words);
  }

  /// Says so where a smaller rms has been bought with a larger worst place.
  void add_largest() {
    std::string worse;
    for (const auto& [rival, numbers] : rivals_)
      if (result_.largest > difference * rival.largest)
        worse += ", " + rival.title + " " + length_words(rival.largest, settings_.unit);
    if (!worse.empty())
      result_.words.push_back("the largest displacement of the skin got worse: optimized " +
                              length_words(result_.largest, settings_.unit) + worse);
  }

  /// A drawing that is scaled costs nothing: whoever gains less from the sequence should take that. What is
  /// of a worse class is no alternative.
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
               length_words(result_.scaled->rms, settings_.unit) + " of the skin's rms";
    result_.words.push_back(words);
  }

  void add_places() {
    if (!reports_.binary.found.places) return;
    const FaultyPlaces& all = *reports_.binary.found.places;
    const std::vector<bool> shared = shared_roofs(all, sequences_);
    for (const bool told_last : {false, true})
      for (std::size_t i = 0; i < all.largest.size(); ++i)
        if (shared[i] == told_last)
          result_.places.push_back((told_last ? "in every sequence: " : "") +
                                   words_of(all.largest[i], all, settings_));
  }

  /// One that is of the same class or a better one: the best alternative, the start.
  struct Rival {
    ComparedSequence compared;
    const SequenceNumbers& numbers;
  };

  const FinalReports& reports_;
  const SequenceNumbers& planar_;
  const ModelSettings& settings_;
  std::vector<const SequenceNumbers*> sequences_;  ///< between which places may decide
  std::vector<Rival> rivals_;
  Headline result_;
};

}  // namespace

Headline make_headline(const FinalReports& reports, const SequenceNumbers& planar,
                       const ModelSettings& settings) {
  return HeadlineWriter(reports, planar, settings).write();
}

}  // namespace fabseq
