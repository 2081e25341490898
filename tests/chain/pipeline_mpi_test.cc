// SPDX-License-Identifier: MIT
/// The chain of stages as a whole: what it leaves for later runs.
#include "fabseq/chain/pipeline.h"
#include "support/pipeline_case.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace fabseq {
namespace {

template <class T>
class PipelineTest : public testing::Test {
 protected:
  static constexpr int dim = T::value;
  /// Two blocks of lanes.
  static Settings settings() { return {{"layers.count", "10"}}; }
  using Results = std::pair<std::vector<std::vector<double>>, std::vector<Design>>;

  static Results results(test::PipelineCase<dim>& pipeline, const Design& design) {
    const auto state = pipeline.run(design);
    const auto& responses = pipeline.problem.responses();
    return {pipeline.pipeline.values(responses, state),
            pipeline.pipeline.gradients(responses, state, {{{0, 0, 1.0}}, {{3, 0, 1.0}}})};
  }
};
TYPED_TEST_SUITE(PipelineTest, test::Dimensions);

/// Memory given back between two runs is taken again with the same bits.
TYPED_TEST(PipelineTest, GivesBackMemoryWithoutAnyChange) {
  test::PipelineCase<TypeParam::value> kept(this->settings()), given(this->settings());
  const Design design = kept.wavy_point();
  (void)this->results(kept, design);
  (void)this->results(given, design);
  given.pipeline.release_memory();
  const auto expected = this->results(kept, design), found = this->results(given, design);
  EXPECT_EQ(found.first, expected.first);
  ASSERT_EQ(found.second.size(), 2u);
  for (int row = 0; row < 2; ++row) {
    EXPECT_EQ(found.second[row].field, expected.second[row].field);
    EXPECT_EQ(found.second[row].layer_variables, expected.second[row].layer_variables);
  }
}

}  // namespace
}  // namespace fabseq
