// SPDX-License-Identifier: MIT
/// What the first sentences say of sequences that can be built and of others.
#include "fabseq/report/headline.h"

#include <gtest/gtest.h>

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
  if (!buildable) result.verdict->broken.push_back({});
  return result;
}

Headline headline(const SequenceReport& binary, const SequenceReport& planar, const SequenceReport& start) {
  FinalReports reports;
  reports.binary = binary;
  reports.start = start;
  return make_headline(reports, planar, false, "mm");
}

TEST(HeadlineTest, BestBuildableBaselineIsCompared) {
  FinalReports reports;
  reports.binary = sequence(1.0, 0.9, true);
  reports.baselines.push_back({"baseline_even", "even layers", "", sequence(2.0, 1.9, true)});
  reports.baselines.push_back({"baseline_tilted", "tilted", "", sequence(1.5, 1.4, false)});
  const Headline result = make_headline(reports, sequence(4.0, 3.9, true), false, "mm");
  ASSERT_TRUE(result.baseline);
  EXPECT_EQ(result.baseline->block, "baseline_even");
  EXPECT_EQ(result.words.front(),
            "the skin distorts 2.0 times less than in the best buildable baseline (even layers)");
  EXPECT_EQ(result.words.size(), 2U);
}

/// A sequence that cannot be built is no alternative, however little it distorts.
TEST(HeadlineTest, NothingIsSaidOfScaledDrawingsThatCannotBeBuilt) {
  const Headline result =
      headline(sequence(1.0, 0.9, true), sequence(2.0, 0.8, false), sequence(0.9, 0.5, false, 0.5));
  EXPECT_FALSE(result.baseline);
  EXPECT_FALSE(result.scaled);
  ASSERT_EQ(result.words.size(), 2U);
  EXPECT_EQ(
      result.words.front(),
      "no baseline is buildable; the skin distorts 2.0 times less than in planar layers, 1.1 times more than "
      "in the start (not buildable)");
}

TEST(HeadlineTest, StartThatCanBeBuiltIsAnAlternative) {
  const Headline result =
      headline(sequence(1.0, 0.9, true), sequence(2.0, 0.4, false), sequence(0.9, 0.5, true, 0.5));
  ASSERT_EQ(result.words.size(), 4U);
  EXPECT_EQ(
      result.words.front(),
      "no baseline but the start is buildable; the skin distorts 2.0 times less than in planar layers, 1.1 "
      "times more than in the start");
  EXPECT_EQ(result.words[2], "the largest displacement of the skin got worse: optimized 1 mm, start 0.5 mm");
  EXPECT_EQ(
      result.words[3],
      "there is nothing to gain from the sequence here, and a drawing that is scaled by 1.01 does more, "
      "without any optimized sequence: it leaves 0.5 mm of the skin's rms");
  ASSERT_TRUE(result.scaled);
  EXPECT_EQ(result.scaled->rms, 0.5);
}

TEST(HeadlineTest, ScaledDrawingOfBaselineThatBeatsAGainIsNamed) {
  const Headline result =
      headline(sequence(1.0, 0.9, false), sequence(2.0, 0.4, true), sequence(1.5, 0.3, false));
  ASSERT_EQ(result.words.size(), 3U);
  EXPECT_EQ(
      result.words.front(),
      "not buildable: the skin distorts 2.0 times less than in the best buildable baseline (planar), 1.5 "
      "times less than in the start (not buildable)");
  EXPECT_EQ(
      result.words[2],
      "a drawing that is scaled by 1.01 does more, without any optimized sequence: it leaves 0.4 mm of the "
      "skin's rms");
}

TEST(HeadlineTest, SetsThatTheLastLayersBuildAreNamed) {
  SequenceReport binary = sequence(1.0, 0.9, true);
  binary.late_sets = {{"edge", 1.0, 1}};
  const Headline result = headline(binary, sequence(4.0, 3.9, true), sequence(2.0, 1.9, true));
  EXPECT_EQ(result.words.back(), binary.late_sets[0].words());
  EXPECT_EQ(result.words.back().find("the last layer builds 100 % of node set edge, which moves"), 0U);
}

}  // namespace
}  // namespace fabseq
