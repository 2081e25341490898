// SPDX-License-Identifier: MIT
/// Deviation of shape (formulation 5): rigid motions and, where the fit may scale, growth leave nothing; what
/// is left of rough displacements is orthogonal to every motion; gradients through the pipeline.
#include "support/pipeline_case.h"
#include "support/refusal.h"
#include "support/response.h"

#include <gtest/gtest.h>

#include <vector>

namespace fabseq {
namespace {

template <class T>
class ShapeDeviationTest : public testing::Test {
 protected:
  static constexpr int dim = T::value;
  using Case = test::PipelineCase<dim>;

  /// The shape of the skin, with these entries of fit.
  static std::unique_ptr<Response<dim>> shape(const Case& pipeline, const std::string& fit) {
    const std::string term =
        R"({"type": "distortion", "measure": "shape", "nodes": "skin", "fit": )" + fit + "}";
    return test::make_response<dim>(TermList::objective, term, pipeline.setup.context());
  }
  static std::vector<double> values(const Response<dim>& response, const StageResults<dim>& state,
                                    const std::vector<double>& displacement) {
    ProcessResult result;
    result.displacement = displacement;
    return response.values({state.time, state.densities, result});
  }
  static double value(Case& pipeline, const StageResults<dim>& state, const std::vector<double>& displacement,
                      const std::string& fit) {
    return values(*shape(pipeline, fit), state, displacement)[0];
  }
  /// A displacement by place, [owned node][component].
  template <class Field>
  static std::vector<double> displacement_of(const Grid<dim>& grid, const Field& field) {
    std::vector<double> result;
    grid.owned_nodes().for_each([&](const Index<dim>& index, std::int64_t) {
      for (int a = 0; a < dim; ++a) result.push_back(field(a, grid.node_position(index)));
    });
    return result;
  }
};
TYPED_TEST_SUITE(ShapeDeviationTest, test::Dimensions);

template <int Dim>
Settings with_skin() {
  const std::string high = Dim == 2 ? "[3.5, 1.5]" : "[2, 0.9, 2.5]", low = Dim == 2 ? "[0, 0]" : "[0, 0, 0]";
  return {{"node_sets.skin", R"({"surface": true, "box": {"min": )" + low + R"(, "max": )" + high + "}}"}};
}

TYPED_TEST(ShapeDeviationTest, WhatTheFitMovesLeavesNothing) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case pipeline(with_skin<Dim>());
  const auto state = pipeline.run(pipeline.wavy_design());
  const Grid<Dim>& grid = pipeline.setup.grid;
  const std::string translation = R"(["translation"])", rigid = R"(["translation", "rotation"])",
                    scaled = R"(["translation", "rotation", "scale"])";
  const auto shift = this->displacement_of(grid, [](int a, const auto&) { return 0.3 - 0.2 * a; });
  for (const auto& fit : {translation, rigid, scaled})
    EXPECT_LT(this->value(pipeline, state, shift, fit), 1e-28);
  for (int k = 0; k < rigid_motion_count<Dim>; ++k) {
    const auto motion =
        this->displacement_of(grid, [&](int a, const auto& x) { return 0.1 * rigid_motion<Dim>(k, a, x); });
    EXPECT_LT(this->value(pipeline, state, motion, rigid), 1e-28);
    if (k >= Dim) {
      EXPECT_GT(this->value(pipeline, state, motion, translation), 1e-4);
    }
  }
  const auto growth = this->displacement_of(grid, [](int a, const auto& x) { return 0.01 * x[a]; });
  EXPECT_LT(this->value(pipeline, state, growth, scaled), 1e-28);
  EXPECT_GT(this->value(pipeline, state, growth, rigid), 1e-5);
}

/// The least value that motions of small amplitude can make of a rough displacement.
TYPED_TEST(ShapeDeviationTest, IsTheLeastOverAllMotions) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case pipeline(with_skin<Dim>());
  const auto state = pipeline.run(pipeline.wavy_design());
  const Grid<Dim>& grid = pipeline.setup.grid;
  const NodeSet& skin = pipeline.setup.node_sets.at("skin");
  const auto rough = this->displacement_of(
      grid, [](int a, const auto& x) { return std::sin(3.0 * x[0] + a) * std::cos(2.0 * x[1] - a); });
  const double least = this->value(pipeline, state, rough, R"(["translation", "rotation"])");
  EXPECT_GT(least, 1e-3);
  for (int k = 0; k < rigid_motion_count<Dim>; ++k) {
    const auto motion =
        this->displacement_of(grid, [&](int a, const auto& x) { return rigid_motion<Dim>(k, a, x); });
    std::vector<double> sums(3, 0.0);  // |u|^2, u . m, |m|^2
    for (const int node : skin.owned)
      for (int a = 0; a < Dim; ++a) {
        const std::size_t i = static_cast<std::size_t>(node) * Dim + a;
        sums[0] += rough[i] * rough[i];
        sums[1] += rough[i] * motion[i];
        sums[2] += motion[i] * motion[i];
      }
    sum_in_place(grid.comm(), sums);
    EXPECT_LT(least, (sums[0] - sums[1] * sums[1] / sums[2]) / static_cast<double>(skin.count) + 1e-12);
  }
}

/// What a fit leaves of linear displacements is uniform strain, and without rotations in the fit these, too.
TYPED_TEST(ShapeDeviationTest, FunctionalsHoldWhatIsLeftOfLinearDisplacements) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case pipeline(with_skin<Dim>());
  const auto state = pipeline.run(pipeline.wavy_design());
  const auto linear = this->displacement_of(pipeline.setup.grid, [](int a, const auto& x) {
    double u = 0.3 - 0.7 * a;
    for (int b = 0; b < Dim; ++b) u += (0.2 + 0.5 * a - 0.4 * b * b) * x[b];
    return u;
  });
  const int strains = Dim * (Dim + 1) / 2;
  for (const auto& [fit, count] :
       {std::pair(R"(["translation"])", Dim * Dim), std::pair(R"(["translation", "rotation"])", strains),
        std::pair(R"(["translation", "rotation", "scale"])", strains - 1)}) {
    const auto response = this->shape(pipeline, fit);
    const auto functionals = response->squares(TermScaling::current);
    ASSERT_TRUE(functionals);
    EXPECT_EQ(functionals->count, count);
    EXPECT_FALSE(functionals->complete);
    const double whole = this->values(*response, state, linear)[0];
    EXPECT_GT(whole, 1e-3);
    double squares = 0.0;
    for (const double r : this->values(*functionals->functionals, state, linear)) squares += r * r;
    EXPECT_NEAR(squares, whole, 1e-12 * whole);
    EXPECT_FALSE(response->squares(TermScaling::first));
  }
}

/// A single node turns and grows by nothing.
TYPED_TEST(ShapeDeviationTest, NodesThatDoNotDetermineTheFitAreRefused) {
  constexpr int Dim = TypeParam::value;
  const std::string corner = Dim == 2 ? "[0, 1.5]" : "[0, 0, 2.5]";
  Settings settings = with_skin<Dim>();
  settings.emplace_back("node_sets.corner", R"({"box": {"min": )" + corner + R"(, "max": )" + corner + "}}");
  typename TestFixture::Case pipeline(settings);
  const auto refusal = [&](const std::string& fit) {
    return test::refusal([&] {
      (void)test::make_response<Dim>(
          TermList::objective,
          R"({"type": "distortion", "measure": "shape", "nodes": "corner", "fit": )" + fit + "}",
          pipeline.setup.context());
    });
  };
  EXPECT_EQ(refusal(R"(["translation"])"), "no error");
  for (const char* fit : {R"(["translation", "rotation"])", R"(["translation", "scale"])"})
    EXPECT_EQ(refusal(fit),
              "/node_sets/corner: its 1 nodes do not determine the fit of measure shape; allowed: nodes that "
              "no motion of the fit leaves in place, or fewer entries in fit");
}

TYPED_TEST(ShapeDeviationTest, GradientsAgreeWithDifferences) {
  constexpr int Dim = TypeParam::value;
  for (const char* deposition : {"follow", "nominal"}) {
    Settings settings = with_skin<Dim>();
    settings.emplace_back("process.deposition", deposition);
    settings.emplace_back("objective", R"([
      {"type": "distortion", "measure": "shape", "nodes": "skin",
       "fit": ["translation", "rotation", "scale"]},
      {"type": "distortion", "measure": "shape", "nodes": "skin"},
      {"type": "distortion", "measure": "layerwise"}, {"type": "distortion", "nodes": "tip"}])");
    typename TestFixture::Case pipeline(settings);
    const auto& responses = pipeline.problem.responses();
    const Design design = pipeline.wavy_point(), direction = pipeline.direction_at(design);
    const auto state = pipeline.run(design);
    std::vector<GradientRow> rows;
    for (int r = 0; r < 4; ++r) rows.push_back({{r, 0, 1.0}});
    const auto gradients = pipeline.pipeline.gradients(responses, state, rows);
    const auto expected = test::central_differences(
        [&](double step) {
          std::vector<double> result;
          const auto at = pipeline.run(test::moved(design, step, direction));
          const auto values = pipeline.pipeline.values(responses, at);
          for (int r = 0; r < 4; ++r) result.push_back(values[r][0]);
          return result;
        },
        2e-3);
    for (int r = 0; r < 4; ++r)
      EXPECT_NEAR(test::dot(gradients[r], direction), expected[r], 1e-6 * std::abs(expected[r]) + 1e-13)
          << deposition << r;
  }
}

}  // namespace
}  // namespace fabseq
