// SPDX-License-Identifier: MIT
/// Scaling of the objective and rows of the constraints, as the optimizer gets them (formulation 9).
#include "fabseq/base/error.h"
#include "fabseq/optimize/problem.h"
#include "support/pipeline_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace fabseq {
namespace {

// Of the config: weights, normalize and scaling of the six terms.
constexpr double weights[] = {1.0, 0.5, 1.0, 2.0, 0.3, 0.7};
constexpr double normalize[] = {100, 10, 100, 100, 100, 20};
constexpr bool current[] = {false, true, false, false, false, true};
constexpr double tolerance = 0.2, slack = 0.01;

template <class T>
class ProblemTest : public testing::Test {
 protected:
  ProblemValues evaluate(const std::vector<double>& design) {
    return case_.problem.evaluate(case_.pipeline, case_.run(design));
  }
  std::vector<double> another_design() const { return test::noise_field(case_.setup.part, 0.1, 0.5, 1); }
  test::PipelineCase<T::value> case_;
};
TYPED_TEST_SUITE(ProblemTest, test::Dimensions);

TYPED_TEST(ProblemTest, FirstEvaluationHasTheNormalizedValues) {
  const ProblemValues values = this->evaluate(this->case_.wavy_design());
  ASSERT_EQ(values.objective.size(), 6u);
  ASSERT_EQ(values.constraints.size(), 2u);
  EXPECT_EQ(values.constraints[0].size(), 4u);
  EXPECT_EQ(values.constraints[1].size(), 3u);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(values.scaled[i], weights[i] * normalize[i], 1e-11 * normalize[i]);
}

TYPED_TEST(ProblemTest, LaterOnesAreRelativeToTheFirstOrTheCurrentValue) {
  const ProblemValues first = this->evaluate(this->case_.wavy_design());
  const ProblemValues second = this->evaluate(this->another_design());
  double merit = 0.0;
  for (int i = 0; i < 6; ++i) {
    const double full = weights[i] * normalize[i];
    const double ratio = second.objective[i][0] / first.objective[i][0];
    EXPECT_GT(std::abs(ratio - 1.0), 1e-3);
    EXPECT_NEAR(second.scaled[i], current[i] ? full : full * ratio, 1e-11 * full);
    merit += current[i] ? full * std::log(second.objective[i][0]) : full * ratio;
  }
  EXPECT_NEAR(second.merit, merit, 1e-11 * std::abs(merit));
}

/// Of the terms that depend on displacements.
TYPED_TEST(ProblemTest, TellsWhatIsLeftOfTheFirstDistortion) {
  auto& pipeline = this->case_;
  const auto state = pipeline.run(pipeline.wavy_design());
  const ProblemValues first = pipeline.problem.evaluate(pipeline.pipeline, state);
  EXPECT_EQ(pipeline.problem.share_left(first), 1.0);
  double smallest = 1.0;
  ProblemValues values = first;
  for (std::size_t i = 0; i < values.objective.size(); ++i) {
    const double factor = 0.5 / static_cast<double>(i + 1);
    values.objective[i][0] *= factor;
    if (pipeline.problem.responses()[i]->uses_displacements()) smallest = std::min(smallest, factor);
  }
  EXPECT_LT(smallest, 1.0);
  EXPECT_DOUBLE_EQ(pipeline.problem.share_left(values), smallest);
}

/// What has fallen to the errors of the solves is not enlarged for the optimizer.
TYPED_TEST(ProblemTest, NegligibleValuesAreNotScaledUp) {
  auto& pipeline = this->case_;
  const auto state = pipeline.run(pipeline.wavy_design());
  const ProblemValues first = pipeline.problem.evaluate(pipeline.pipeline, state);
  ProcessResult small = *state.process;
  for (double& u : small.displacement) u *= 1e-9;
  const ProblemValues values =
      pipeline.problem.evaluate(pipeline.pipeline, {state.time, state.densities, small});
  int compared = 0;
  for (int i = 0; i < 6; ++i) {
    const double share = values.objective[i][0] / first.objective[i][0];
    if (!current[i] || share > 1e-12) continue;
    EXPECT_NEAR(values.scaled[i], weights[i] * normalize[i] * share / 1e-12, 1e-9) << i;
    ++compared;
  }
  EXPECT_GT(compared, 0);
}

/// What is 0 but for rounding says nothing of how large it may become.
TYPED_TEST(ProblemTest, WhatBeginsWithRoundingIsScaledByItsSize) {
  auto& pipeline = this->case_;
  const auto state = pipeline.run(pipeline.wavy_design());
  const double size = std::pow(0.01 * pipeline.setup.part.longest_edge(), 2);  // strain times length
  for (const double factor : {0.0, 1e-12}) {
    test::PipelineCase<TypeParam::value> other;
    ProcessResult small = *state.process;
    for (double& u : small.displacement) u *= factor;
    const ProblemValues first =
        other.problem.evaluate(pipeline.pipeline, {state.time, state.densities, small});
    const ProblemValues second = other.problem.evaluate(pipeline.pipeline, state);
    for (const int i : {0, 1}) {
      const double value = second.objective[i][0];
      EXPECT_LE(first.objective[i][0], 1e-12 * size);
      EXPECT_LT(first.scaled[i], 1e-6 * weights[i] * normalize[i]);
      const double reference = current[i] ? std::max(value, 1e-4 * size) : 1e-4 * size;
      EXPECT_NEAR(second.scaled[i], weights[i] * normalize[i] * value / reference, 1e-9) << i;
    }
    EXPECT_EQ(other.problem.share_left(second), 1.0);
  }
}

/// The objective's gradient is that of the merit: a term scaled by its current value c J / J is c ln J.
TYPED_TEST(ProblemTest, GradientsAgreeWithDifferencesOfMeritAndRows) {
  auto& pipeline = this->case_;
  (void)this->evaluate(this->another_design());  // not the design of the gradients
  const std::vector<double> design = pipeline.wavy_design();
  const auto direction = pipeline.direction(design);
  const auto state = pipeline.run(design);
  const ProblemValues values = pipeline.problem.evaluate(pipeline.pipeline, state);
  const ProblemGradients gradients = pipeline.problem.gradients(pipeline.pipeline, state, values);
  // Merit, then every row once more.
  const auto expected = test::central_differences(
      [&](double step) {
        const auto moved_state = pipeline.run(test::moved(design, step, direction));
        const ProblemValues moved = pipeline.problem.evaluate(pipeline.pipeline, moved_state);
        std::vector<double> all = {moved.merit};
        for (const auto& components : moved.constraints)
          for (const double value : components) {
            all.push_back(value);
            all.push_back(-value);
          }
        return all;
      },
      2e-3);
  EXPECT_NEAR(test::dot(gradients.objective.field, direction), expected[0], 1e-6 * std::abs(expected[0]));
  ASSERT_EQ(gradients.constraints.size(), 2u * (4 + 3));
  for (std::size_t row = 0; row < gradients.constraints.size(); ++row)
    EXPECT_NEAR(test::dot(gradients.constraints[row].gradient.field, direction), expected[row + 1],
                1e-6 * std::abs(expected[row + 1]))
        << row;
}

/// Bounds 1 +- tolerance of the thickness, -slack to 0 of the speed, shrunk about their centres.
std::vector<double> expected_rows(const ProblemValues& values, double margin) {
  std::vector<double> result;
  for (const double thickness : values.constraints[0]) {
    result.push_back(thickness - 1.0 - margin * tolerance);
    result.push_back(1.0 - margin * tolerance - thickness);
  }
  for (const double speed : values.constraints[1]) {
    result.push_back(speed + 0.5 * slack - margin * 0.5 * slack);
    result.push_back(-0.5 * slack - margin * 0.5 * slack - speed);
  }
  return result;
}

TYPED_TEST(ProblemTest, RowsHaveTheMarginAndTheWorstHasNone) {
  for (const char* margin : {"0.95", "0.5"}) {
    test::PipelineCase<TypeParam::value> pipeline(Settings{{"optimizer.constraint_margin", margin}});
    const auto state = pipeline.run(pipeline.wavy_design());
    const ProblemValues values = pipeline.problem.evaluate(pipeline.pipeline, state);
    const auto rows = pipeline.problem.gradients(pipeline.pipeline, state, values).constraints;
    const auto expected = expected_rows(values, std::stod(margin));
    ASSERT_EQ(rows.size(), expected.size());
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_NEAR(rows[i].value, expected[i], 1e-14);
    const auto plain = expected_rows(values, 1.0);
    EXPECT_NEAR(values.worst_constraint, *std::max_element(plain.begin(), plain.end()), 1e-14);
  }
}

TYPED_TEST(ProblemTest, WithoutConstraintsEverythingIsFeasible) {
  test::PipelineCase<TypeParam::value> pipeline(Settings{{"constraints", "[]"}});
  const auto state = pipeline.run(pipeline.wavy_design());
  const ProblemValues values = pipeline.problem.evaluate(pipeline.pipeline, state);
  EXPECT_EQ(values.worst_constraint, 0.0);
  EXPECT_TRUE(values.constraints.empty());
  EXPECT_TRUE(pipeline.problem.gradients(pipeline.pipeline, state, values).constraints.empty());
}

TYPED_TEST(ProblemTest, NamesComponentsAsTheContractDoes) {
  const ProblemValues values = this->evaluate(this->case_.wavy_design());
  auto all = values.objective;
  all.insert(all.end(), values.constraints.begin(), values.constraints.end());
  const auto described = this->case_.problem.describe(all);
  ASSERT_EQ(described.size(), 6u + 4 + 3);
  EXPECT_EQ(described[5].name, "objective_5");
  EXPECT_EQ(described[5].type, "layer_uniformity");
  EXPECT_EQ(described[7].name, "constraint_0_1");
  EXPECT_EQ(described[7].type, "layer_thickness");
  EXPECT_EQ(described[7].value, values.constraints[0][1]);
  EXPECT_EQ(described[12].name, "constraint_1_2");
  EXPECT_EQ(described[12].type, "deposition_speed");
}

/// A value that is no number stops the run, naming the term.
TYPED_TEST(ProblemTest, RefusesValuesThatAreNotFinite) {
  auto& pipeline = this->case_;
  const auto state = pipeline.run(pipeline.wavy_design());
  ProcessResult broken = *state.process;
  for (double& u : broken.displacement) u = NAN;
  try {
    (void)pipeline.problem.evaluate(pipeline.pipeline, {state.time, state.densities, broken});
    ADD_FAILURE() << "nothing thrown";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("objective_0 (distortion)"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace fabseq
