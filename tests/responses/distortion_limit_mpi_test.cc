// SPDX-License-Identifier: MIT
/// Distortion as a constraint (formulation 7): the root of every measure, its row, its gradients.
#include "support/measure_case.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

using test::operator+;

/// Keys of every measure.
const std::vector<std::string> measures_of_sets = {R"("nodes": "tip")",
                                                   R"("nodes": "tip", "mean": true)",
                                                   R"("nodes": "tip", "norm": 8)",
                                                   R"("measure": "flatness", "nodes": "top", "axis": "x")",
                                                   R"("measure": "shape", "nodes": "top")",
                                                   R"("measure": "angle", "nodes": "top", "to": "tip")"};

template <class T>
class DistortionLimitTest : public testing::Test {
 protected:
  static constexpr int dim = T::value;
};
TYPED_TEST_SUITE(DistortionLimitTest, test::Dimensions);

TYPED_TEST(DistortionLimitTest, IsTheRootOfTheMeasure) {
  test::MeasureCase<TypeParam::value> measures;
  const auto u = measures.rough_displacement(0.01), nothing = measures.rough_displacement(0.0);
  for (const std::string& keys : measures_of_sets) {
    const auto measure = measures.make(keys);
    const auto limit = measures.make(keys + R"(, "limit": 0.2)", TermList::constraints);
    const double root = measures.value(*limit, u);
    EXPECT_DOUBLE_EQ(root, std::sqrt(measures.value(*measure, u)));
    EXPECT_LT(measures.error_of_derivative(*limit, u, 1e-6), 1e-6) << keys;
    // Where nothing moves, there is no derivative, but a finite one for the optimizer.
    EXPECT_LT(measures.value(*limit, nothing), 1e-12) << keys;
    for (const double entry : measures.derivative(*limit, nothing).displacement)
      EXPECT_TRUE(std::isfinite(entry)) << keys;
    EXPECT_FALSE(limit->squares(TermScaling::current));
  }
}

TYPED_TEST(DistortionLimitTest, HasOneRowRelativeToTheLimit) {
  test::MeasureCase<TypeParam::value> measures;
  const auto limit = measures.make(R"("nodes": "tip", "limit": 0.2)", TermList::constraints);
  const auto rows = limit->rows(0.95);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_DOUBLE_EQ(rows[0].violation(0.19), 0.0);
  EXPECT_DOUBLE_EQ(rows[0].violation(0.39), 1.0);
  EXPECT_DOUBLE_EQ(limit->rows(1.0)[0].violation(0.2), 0.0);
}

/// Through the whole pipeline, on the plate and after the release.
TYPED_TEST(DistortionLimitTest, GradientsAgreeWithDifferences) {
  constexpr int Dim = TypeParam::value;
  for (const bool release : {false, true}) {
    std::string constraints = R"({"type": "distortion", "measure": "layerwise", "limit": 1})";
    for (const std::string& keys : measures_of_sets)
      constraints += R"(, {"type": "distortion", )" + keys + R"(, "limit": 1, "after_release": )" +
                     to_text(release) + "}";
    const Settings settings =
        test::on_clamped_substrate<Dim>() +
        Settings{{"objective",
                  R"([{"type": "distortion", "nodes": "tip", "after_release": )" + to_text(release) + "}]"},
                 {"constraints", "[" + constraints + "]"}};
    test::PipelineCase<Dim> pipeline(settings);
    const auto& responses = pipeline.problem.responses();
    ASSERT_EQ(responses.size(), 2 + measures_of_sets.size());
    const Design design = pipeline.wavy_point(), direction = pipeline.direction_at(design);
    const auto state = pipeline.run(design);
    std::vector<GradientRow> rows;
    for (std::size_t r = 0; r < responses.size(); ++r) rows.push_back({{static_cast<int>(r), 0, 1.0}});
    const auto gradients = pipeline.pipeline.gradients(responses, state, rows);
    const auto expected = test::central_differences(
        [&](double step) {
          std::vector<double> result;
          for (const auto& values :
               pipeline.pipeline.values(responses, pipeline.run(test::moved(design, step, direction))))
            result.push_back(values[0]);
          return result;
        },
        2e-3);
    for (std::size_t r = 0; r < responses.size(); ++r)
      EXPECT_NEAR(test::dot(gradients[r], direction), expected[r], 1e-6 * std::abs(expected[r]) + 1e-13)
          << release << r;
  }
}

}  // namespace
}  // namespace fabseq
