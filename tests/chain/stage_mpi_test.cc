// SPDX-License-Identifier: MIT
/// A stage that nothing else knows of: it registers itself here, and the pipeline goes through it both ways.
#include "fabseq/chain/stage.h"
#include "support/pipeline_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {
namespace {

constexpr double slope = 0.7;

/// The strains of another source, each step's times a factor. The inputs are those of the source, then the
/// factors.
template <int Dim>
class FactorStrain : public StrainSource<Dim> {
 public:
  FactorStrain(const StrainSource<Dim>& source, std::vector<double> factors)
      : source_(source), factors_(std::move(factors)) {}

  StrainVariation variation() const override {
    return std::max(source_.variation(), StrainVariation::by_step);
  }
  void set_strains(std::span<const int> elements, const StepBlock& steps,
                   std::span<double> strains) const override {
    source_.set_strains(elements, steps, strains);
    for (std::size_t i = 0; i < strains.size(); ++i) strains[i] *= factors_[steps.first + i % steps.lanes];
  }
  std::size_t input_count() const override { return source_.input_count() + factors_.size(); }
  void add_derivatives(std::span<const int> elements, const StepBlock& steps,
                       std::span<const double> d_strains, std::span<double> d_inputs) const override {
    const std::size_t of_source = source_.input_count();
    std::vector<double> values(d_strains.size()), scaled(d_strains.begin(), d_strains.end());
    source_.set_strains(elements, steps, values);
    for (std::size_t i = 0; i < scaled.size(); ++i) {
      const std::size_t step = steps.first + i % steps.lanes;
      d_inputs[of_source + step] += d_strains[i] * values[i];
      scaled[i] *= factors_[step];
    }
    source_.add_derivatives(elements, steps, scaled, d_inputs.first(of_source));
  }

 private:
  const StrainSource<Dim>& source_;
  std::vector<double> factors_;
};

/// Scales the inherent strain of layer j by 1 + slope V_j, where V_j is the sum of its densities over their
/// number, as a temperature would that follows from the size of a layer.
template <int Dim>
class FactorStage : public Stage<Dim> {
 public:
  explicit FactorStage(StageContext<Dim>& context)
      : comm_(context.model.grid.comm()), elements_(static_cast<double>(context.model.part.count())) {}

  void forward(const StageInput& /*input*/, StageResults<Dim>& results) override {
    const LayerDensities& layers = *results.densities;
    std::vector<double> factors;
    for (const std::vector<double>& density : layers.layer) factors.push_back(1.0 + slope * volume(density));
    scaled_.emplace(*results.strains, std::move(factors));
    results.strains = *scaled_;
  }

  void pull_back(const StageResults<Dim>& state, const SolveTolerance& /*tolerance*/,
                 AdjointRowSpan<Dim> rows) override {
    for (AdjointRow<Dim>* row : rows) {
      std::vector<double>& d_inputs = row->adjoint.strains.inputs;
      if (d_inputs.empty()) continue;
      const auto first = d_inputs.end() - state.densities->count();
      for (int j = 0; j < state.densities->count(); ++j) {
        const double d_volume = slope * sum(comm_, first[j]) / elements_;
        auto& d_layer = DensityDerivatives::zeros_if_empty(row->adjoint.densities.layer[j],
                                                           state.densities->layer[j].size());
        for (double& derivative : d_layer) derivative += d_volume;
      }
      d_inputs.erase(first, d_inputs.end());
    }
  }
  Phase phase() const override { return Phase::layers; }

 private:
  double volume(const std::vector<double>& density) const {
    return sum(comm_, std::accumulate(density.begin(), density.end(), 0.0)) / elements_;
  }

  MPI_Comm comm_;
  double elements_;
  std::optional<FactorStrain<Dim>> scaled_;
};

StageCost no_cost(const RunSize&, SolverPath, int, int) { return {.seconds = 1e9}; }
const RegisteredStage<FactorStage> factor_stage{
    {"factors", {&Results::densities, &Results::strains}, {&Results::strains}}, no_cost};

TEST(StageTest, OrderFollowsFromResults) {
  std::vector<std::string> names;
  for (const StageType* type : stage_types()) names.push_back(type->name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"sequence", "layers", "temperature", "strain", "factors", "process"}));
}

TEST(StageTest, CostsAreAskedOfEveryStage) {
  EXPECT_GT(iteration_seconds_estimate({.unknowns = 1000.0, .layers = 3}, SolverPath::lanes), 1e9);
}

template <class T>
class FactorStageTest : public testing::Test {};
TYPED_TEST_SUITE(FactorStageTest, test::Dimensions);

/// With strains of the material, of the elements and of the layers' sub-parts.
TYPED_TEST(FactorStageTest, GradientsAgreeWithDifferences) {
  constexpr int Dim = TypeParam::value;
  const std::string turning = R"({"tangential": -0.01, "normal": 0.003})";
  const std::string angles = Dim == 2 ? "[[1.4], [0.9]]" : "[[1.4, 0.3], [0.9, 0.5]]";
  const std::string bounds = Dim == 2 ? "[0, 1.6]" : "[[0, 1.6], [0, 1.6]]";
  const Settings multi_planar = {
      {"layers",
       R"({"type": "multi_planar", "subparts": 2, "timestamps": [0.5], "thickness": 0.5, "angles": )" +
           angles + R"(, "angle_bounds": )" + bounds + R"(, "sharpness": {"time": 8, "slab": 8}})"},
      {"objective", R"([{"type": "distortion", "nodes": "tip"}])"},
      {"constraints", "[]"},
      {"projection", R"({"beta": "auto"})"}};
  for (const Settings& settings : {Settings{}, Settings{{"material.inherent_strain", turning}},
                                   test::operator+(multi_planar, {{"material.inherent_strain", turning}})}) {
    test::PipelineCase<Dim> pipeline(settings);
    const Design design = pipeline.wavy_point(), direction = pipeline.direction_at(design);
    const auto value = [&](double step) {
      const auto state = pipeline.run(test::moved(design, step, direction));
      return pipeline.pipeline.values(pipeline.problem.responses(), state)[0][0];
    };
    const auto state = pipeline.run(design);
    const auto gradients = pipeline.pipeline.gradients(pipeline.problem.responses(), state, {{{0, 0, 1.0}}});
    const double expected = test::central_difference(value, 1e-4);
    EXPECT_NEAR(test::dot(gradients[0], direction), expected, 1e-5 * std::abs(expected));
  }
}

}  // namespace
}  // namespace fabseq
