// SPDX-License-Identifier: MIT
/// What the first sentences say of sequences that can be built and of others.
#include "fabseq/report/headline.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

/// Numbers of a sequence: rms and largest displacement of the skin, and what a scaled drawing leaves of the
/// rms.
SequenceReport sequence(double rms, double scaled_rms, bool buildable, double largest = 1.0) {
  SequenceReport result;
  result.finished.emplace();
  result.finished->as_built.skin.rms = rms;
  result.finished->as_built.skin.largest = largest;
  result.finished->as_built.scaled = {1.01, scaled_rms};
  result.verdict.emplace();
  if (buildable) return result;
  result.verdict->broken.push_back({});
  result.verdict->build_class = BuildClass::not_buildable;
  return result;
}

/// With so many places smaller than a bead.
SequenceReport but_for(std::int64_t places, double rms) {
  SequenceReport result = sequence(rms, rms, false);
  result.verdict->build_class = BuildClass::buildable_but_for_places;
  result.verdict->places = places;
  return result;
}

ModelSettings settings() {
  ModelSettings result;
  result.unit = "mm";
  return result;
}

Headline headline(const SequenceReport& binary, const SequenceReport& planar, const SequenceReport& start) {
  FinalReports reports;
  reports.binary = binary;
  reports.start = start;
  return make_headline(reports, planar, settings());
}

TEST(HeadlineTest, BestBuildableBaselineIsCompared) {
  FinalReports reports;
  reports.binary = sequence(1.0, 0.9, true);
  reports.baselines.push_back({"baseline_even", "even layers", "", sequence(2.0, 1.9, true)});
  reports.baselines.push_back({"baseline_tilted", "tilted", "", sequence(1.5, 1.4, false)});
  const Headline result = make_headline(reports, sequence(4.0, 3.9, true), settings());
  ASSERT_TRUE(result.alternative);
  EXPECT_EQ(result.alternative->block, "baseline_even");
  EXPECT_EQ(
      result.words.front(),
      "buildable: the skin distorts 2.0 times less than in the best alternative (even layers, buildable)");
  EXPECT_EQ(result.words.size(), 1U);
  EXPECT_EQ(result.planar.length, 4.0);
}

/// A sequence that cannot be built is no alternative, however little it distorts.
TEST(HeadlineTest, NothingIsSaidOfScaledDrawingsThatCannotBeBuilt) {
  const Headline result =
      headline(sequence(1.0, 0.9, true), sequence(2.0, 0.8, false), sequence(0.9, 0.5, false, 0.5));
  EXPECT_FALSE(result.alternative);
  EXPECT_FALSE(result.scaled);
  ASSERT_EQ(result.words.size(), 1U);
  EXPECT_EQ(result.words.front(),
            "buildable: no baseline is of this class; the skin distorts 2.0 times less than in planar layers "
            "(not buildable)");
}

TEST(HeadlineTest, StartThatCanBeBuiltIsAnAlternative) {
  const Headline result =
      headline(sequence(1.0, 0.9, true), sequence(2.0, 0.4, false), sequence(0.9, 0.5, true, 0.5));
  ASSERT_EQ(result.words.size(), 3U);
  EXPECT_EQ(result.words.front(),
            "buildable: no baseline is of this class; the skin distorts 2.0 times less than in planar layers "
            "(not buildable), 1.1 times more than in the start");
  EXPECT_EQ(result.words[1], "the largest displacement of the skin got worse: optimized 1 mm, start 0.5 mm");
  EXPECT_EQ(
      result.words[2],
      "there is nothing to gain from the sequence here, and a drawing that is scaled by 1.01 does more, "
      "without any optimized sequence: it leaves 0.5 mm of the skin's rms");
  ASSERT_TRUE(result.scaled);
  EXPECT_EQ(result.scaled->rms, 0.5);
}

TEST(HeadlineTest, ScaledDrawingOfBaselineThatBeatsAGainIsNamed) {
  const Headline result =
      headline(sequence(1.0, 0.9, false), sequence(2.0, 0.4, true), sequence(1.5, 0.3, false));
  ASSERT_EQ(result.words.size(), 2U);
  EXPECT_EQ(
      result.words.front(),
      "not buildable: the skin distorts 2.0 times less than in the best alternative (planar, buildable), "
      "1.5 times less than in the start");
  EXPECT_EQ(
      result.words[1],
      "a drawing that is scaled by 1.01 does more, without any optimized sequence: it leaves 0.3 mm of the "
      "skin's rms");
}

/// A baseline of a worse class is no alternative, one of a better class is.
TEST(HeadlineTest, AlternativesAreOfTheSameClassOrABetterOne) {
  FinalReports reports;
  reports.binary = but_for(2, 1.0);
  reports.baselines.push_back({"baseline_even", "even layers", "", but_for(1, 2.0)});
  reports.baselines.push_back({"baseline_tilted", "tilted", "", sequence(1.5, 1.4, false)});
  EXPECT_EQ(make_headline(reports, sequence(4.0, 3.9, true), settings()).words.front(),
            "buildable but for 2 places: the skin distorts 2.0 times less than in the best alternative (even "
            "layers, buildable but for 1 place)");
  reports.binary = sequence(1.0, 1.0, true);
  const Headline strict = make_headline(reports, sequence(4.0, 3.9, true), settings());
  ASSERT_TRUE(strict.alternative);
  EXPECT_EQ(strict.alternative->block, "baseline");
  EXPECT_EQ(strict.alternative->ratio, 4.0);
}

/// A finding with a sentence.
class Sentence : public FoundNumbers {
 public:
  Sentence(std::string words, ToldIn place) : words_(std::move(words)), place_(place) {}
  void add_record(Json& /*block*/) const override {}
  std::vector<std::string> words() const override { return {words_}; }
  ToldIn told_in() const override { return place_; }

 private:
  std::string words_;
  ToldIn place_;
};

TEST(HeadlineTest, FindingsOfTheHeadlineAreNamed) {
  SequenceReport binary = sequence(1.0, 0.9, true);
  binary.found.add("a", std::make_shared<Sentence>("told", ToldIn::headline));
  binary.found.add("b", std::make_shared<Sentence>("told in the table", ToldIn::table));
  binary.found.add("c", std::make_shared<Sentence>("told last", ToldIn::headline));
  const Headline result = headline(binary, sequence(4.0, 3.9, true), sequence(2.0, 1.9, true));
  ASSERT_EQ(result.words.size(), 3U);
  EXPECT_EQ(result.words[1], "told");
  EXPECT_EQ(result.words[2], "told last");
}

}  // namespace
}  // namespace fabseq
