// SPDX-License-Identifier: MIT
/// The chain of stages as a whole: what it leaves for later runs.
#include "fabseq/chain/pipeline.h"
#include "fabseq/chain/stages.h"
#include "support/pipeline_case.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <span>
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

/// The sequence of a model, which counts for how many designs it is asked.
template <int Dim>
class CountedSequence : public Sequence<Dim> {
 public:
  CountedSequence(const Model<Dim>& model, double tolerance, int& updates)
      : sequence_(make_sequence(model, tolerance)), updates_(updates) {}

  bool has_design() const override { return sequence_->has_design(); }
  std::size_t variables() const override { return sequence_->variables(); }
  DesignSpace space() const override { return sequence_->space(); }
  const PseudoTime<Dim>& update(std::span<const double> design) override {
    ++updates_;
    return sequence_->update(design);
  }
  std::vector<std::vector<double>> pull_back(std::span<const TimeDerivatives> rows) override {
    return sequence_->pull_back(rows);
  }
  void set_tolerance(const SolveTolerance& tolerance) override { sequence_->set_tolerance(tolerance); }
  void start_cold() override { sequence_->start_cold(); }

 private:
  std::unique_ptr<Sequence<Dim>> sequence_;
  int& updates_;
};

/// Binary layers, found first and more closely, leave the pseudo-time to the smooth ones.
TYPED_TEST(PipelineTest, FindsTheTimeOfADesignOnce) {
  constexpr int dim = TypeParam::value;
  test::PipelineCase<dim> fresh(this->settings());
  const Setup<dim>& setup = fresh.setup;
  int updates = 0;
  Pipeline<dim> pipeline(setup, std::make_unique<CountedSequence<dim>>(setup, 1e-13, updates), *setup.layers,
                         1e-13, fresh.timer);
  const auto run = [&](const Design& design, double tolerance, bool binary) {
    pipeline.set_tolerances(Tolerances::all({tolerance}));
    return pipeline.run(design, setup.layers->traits().first_beta, binary);
  };
  const Design design = fresh.wavy_point();
  Design other = design;
  for (double& value : other.field) value *= 0.99;

  (void)run(design, 1e-4, true);
  (void)run(design, 1e-3, false);
  EXPECT_EQ(updates, 1);
  (void)run(design, 1e-5, false);
  EXPECT_EQ(updates, 2) << "a closer one";
  (void)run(other, 1e-3, false);
  EXPECT_EQ(updates, 3) << "another design";
  pipeline.start_cold();
  (void)run(other, 1e-3, true);
  EXPECT_EQ(updates, 4) << "a cold start";

  const std::vector<GradientRow> rows = {{{0, 0, 1.0}}, {{3, 0, 1.0}}};
  const auto& responses = fresh.problem.responses();
  (void)run(other, 1e-13, true);
  const auto state = run(other, 1e-13, false);
  EXPECT_EQ(updates, 5);
  const std::vector<Design> found = pipeline.gradients(responses, state, rows);
  const std::vector<Design> expected = this->results(fresh, other).second;
  for (std::size_t row = 0; row < rows.size(); ++row) EXPECT_EQ(found[row].field, expected[row].field);
}

}  // namespace
}  // namespace fabseq
