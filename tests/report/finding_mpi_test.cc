// SPDX-License-Identifier: MIT
/// A finding that nothing else knows of: it registers itself here, and its record, field, words, cell and
/// limit stand where those of other findings do.
#include "fabseq/output/records.h"
#include "fabseq/output/summary_table.h"
#include "fabseq/report/build_report.h"
#include "fabseq/report/finding.h"
#include "fabseq/report/sequence_report.h"
#include "support/pipeline_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace fabseq {
namespace {

/// Elements of the first layer, more than there may be.
class FirstLayerNumbers : public FoundNumbers {
 public:
  explicit FirstLayerNumbers(MarkedElements marked) : marked_(std::move(marked)) {}

  template <int Dim>
  static std::optional<FirstLayerNumbers> measure(const MeasuredSequence<Dim>& sequence,
                                                  BuildFields& fields) {
    std::vector<double> first;
    for (const double layer : sequence.layer_index) first.push_back(layer == 1.0 ? 1.0 : 0.0);
    FirstLayerNumbers result(sequence.count(first, MarkedPlace::largest));
    fields.add({"first_layer", std::move(first), 1, /*with_binary=*/true});
    return result;
  }

  void add_record(Json& block) const override { block["first_layer"] = marked_.elements; }
  std::vector<TableCell> cells(const Found& /*all*/) const override {
    return {{15, "first layer", std::to_string(marked_.elements)}};
  }
  std::optional<BrokenLimit> broken_limit() const override {
    return BrokenLimit{.name = "first_layer", .share = 1.0, .worst = 2.0, .words = "all is too low"};
  }
  std::vector<std::string> words() const override { return {"the first layer is low", "so is the second"}; }
  ToldIn told_in() const override { return ToldIn::table; }
  std::vector<std::string> doubts() const override { return {"first_layer: low"}; }

  std::int64_t elements() const { return marked_.elements; }

 private:
  MarkedElements marked_;
};

const RegisteredFinding<FirstLayerNumbers> first_layer({"first_layer", 55, MeasuredIn::checks});

template <int Dim>
class FindingCase : public test::PipelineCase<Dim> {
 public:
  SequenceReport report(bool with_shape = true) {
    const auto state = this->run(this->wavy_point());
    return report_sequence(this->setup, this->problem, this->pipeline, state, with_shape);
  }
};

template <class T>
class FindingTest : public testing::Test {};
TYPED_TEST_SUITE(FindingTest, test::Dimensions);

TEST(FindingsTest, AreInTheOrderOfTheirRanks) {
  std::vector<std::string> names;
  for (const Finding* finding : findings()) names.push_back(finding->name);
  EXPECT_EQ(names, (std::vector<std::string>{"gradient", "blocked", "tilt", "local_thickness", "late",
                                             "first_layer", "hanging", "interior_extrema", "stock",
                                             "build_time", "stress", "interpass", "late_sets"}));
}

TYPED_TEST(FindingTest, RecordAndWordsStandInTheBlock) {
  FindingCase<TypeParam::value> of;
  const SequenceReport report = of.report();
  const Json record = to_record(report, of.setup.settings);
  const auto* found = report.found.template find<FirstLayerNumbers>();
  ASSERT_NE(found, nullptr);
  EXPECT_GT(found->elements(), 0);
  EXPECT_EQ(record.at("first_layer").get<std::int64_t>(), found->elements());
  EXPECT_EQ(record.at("words").at("first_layer"), Json(found->words()));
  EXPECT_EQ(report.found.words_of("first_layer"), found->words());
  EXPECT_EQ(report.found.doubts().front(), "first_layer: low");
  EXPECT_TRUE(record.at("checks").contains("hanging"));
}

TYPED_TEST(FindingTest, FieldsStandAmongThoseOfTheSequence) {
  constexpr int Dim = TypeParam::value;
  FindingCase<Dim> of;
  SequenceReport report = of.report();
  const auto names = [&] {
    FieldSet<Dim> fields{&of.setup.grid, {}};
    add_build_fields(fields, of.setup.part, report.build_fields, "even/");
    std::vector<std::string> result;
    for (const auto& field : fields.fields) result.push_back(field.name);
    return result;
  };
  const std::vector<std::string> all = names();
  EXPECT_EQ(std::count(all.begin(), all.end(), "even/first_layer"), 1);
  EXPECT_EQ(std::count(all.begin(), all.end(), "even/hanging"), 1);
  report.build_fields.keep_binary();
  EXPECT_EQ(names(), std::vector<std::string>{"even/first_layer"});
}

TYPED_TEST(FindingTest, CellAndWordsStandInTheTable) {
  FindingCase<TypeParam::value> of;
  const SequenceReport report = of.report();
  const std::vector<std::string> lines = simulation_table(report, of.setup.settings);
  EXPECT_EQ(lines[0].find("not buildable: all is too low"), 0U) << lines[0];
  EXPECT_NE(lines[1].find("  first layer  tilt (no limit)"), std::string::npos) << lines[1];
  EXPECT_EQ(std::vector(lines.end() - 2, lines.end()), report.found.words_of("first_layer"));
}

/// Other reports have neither checks nor words.
TYPED_TEST(FindingTest, EvaluationsHaveNoChecks) {
  FindingCase<TypeParam::value> of;
  const SequenceReport report = of.report(/*with_shape=*/false);
  EXPECT_TRUE(report.found.entries().empty());
  const Json record = to_record(report, of.setup.settings);
  EXPECT_FALSE(record.contains("checks") || record.contains("words"));
}

}  // namespace
}  // namespace fabseq
