// SPDX-License-Identifier: MIT
/// A stage that nothing else knows of: it registers itself here, and the pipeline goes through it both ways.
#include "fabseq/optimize/stage.h"
#include "support/pipeline_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

namespace fabseq {
namespace {

constexpr double slope = 0.7;

/// Scales the inherent strain of layer j by 1 + slope V_j, where V_j is the sum of its densities over their
/// number, as a temperature would that follows from the size of a layer.
template <int Dim>
class FactorStage : public Stage<Dim> {
 public:
  explicit FactorStage(StageContext<Dim>& context)
      : comm_(context.model.grid.comm()), elements_(static_cast<double>(context.model.part.count())) {}

  void forward(const StageInput& /*input*/, StageResults<Dim>& results) override {
    const LayerDensities& layers = *results.layers;
    StrainField& strains = results.strains;
    if (strains.of_layers.empty()) strains.of_layers.assign(layers.count() * components, 1.0);
    unscaled_ = strains.of_layers;
    for (int j = 0; j < layers.count(); ++j)
      for (std::size_t c = 0; c < components; ++c)
        strains.of_layers[j * components + c] *= 1.0 + slope * volume(layers.layer[j]);
  }

  void pull_back(const PipelineState<Dim>& state, const SolveTolerance& /*tolerance*/,
                 AdjointRowSpan<Dim> rows) override {
    for (AdjointRow<Dim>* row : rows) {
      std::vector<double>& d_strain = row->adjoint.strains.of_layers;
      if (d_strain.empty()) continue;
      for (int j = 0; j < state.layers.count(); ++j) {
        const std::vector<double>& density = state.layers.layer[j];
        const auto at = d_strain.begin() + static_cast<std::ptrdiff_t>(j * components);
        const double d_factor =
            std::inner_product(at, at + components, unscaled_.begin() + (at - d_strain.begin()), 0.0);
        const double d_volume = slope * sum(comm_, d_factor) / elements_;
        for (double& derivative : DensityDerivatives::touch(row->adjoint.densities.layer[j], density.size()))
          derivative += d_volume;
        for (std::size_t c = 0; c < components; ++c) at[c] *= 1.0 + slope * volume(density);
      }
    }
  }
  Phase phase() const override { return Phase::layers; }

 private:
  static constexpr std::size_t components = voigt_size<Dim>;
  double volume(const std::vector<double>& density) const {
    return sum(comm_, std::accumulate(density.begin(), density.end(), 0.0)) / elements_;
  }

  MPI_Comm comm_;
  double elements_;
  std::vector<double> unscaled_;
};

StageCost no_cost(const RunSize&, SolverPath, int, int) { return {.seconds = 1e9}; }
const RegisteredStage<FactorStage> factor_stage{{"factors", {"layers", "strains"}, {"strains"}}, no_cost};

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
