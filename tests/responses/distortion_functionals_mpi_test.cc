// SPDX-License-Identifier: MIT
/// Distortion as a sum of squares (docs/developer/optimizer.md 9.2): the functionals against fits by hand,
/// what they leave, their gradients.
#include "support/pipeline_case.h"
#include "support/response.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

namespace fabseq {
namespace {

using test::operator+;

const Settings squares_of_all = {
    {"objective", R"([{"type": "distortion", "nodes": "tip", "least_squares": true, "scaling": "first"},
                      {"type": "distortion", "nodes": "tip", "mean": true, "weight": 0.5, "least_squares": true},
                      {"type": "distortion", "nodes": "top", "measure": "flatness", "axis": "x", "least_squares": true},
                      {"type": "layer_uniformity"}])"}};
const Settings squares_after_release = {
    {"objective", R"([{"type": "distortion", "nodes": "tip", "after_release": true, "least_squares": true},
                      {"type": "distortion", "nodes": "top", "measure": "flatness", "axis": "x", "after_release": true,
                       "least_squares": true}])"}};

template <class T>
class DistortionFunctionalsTest : public testing::Test {
 protected:
  static constexpr int dim = T::value;
  using Case = test::PipelineCase<dim>;

  static std::unique_ptr<Response<dim>> displacement(const Case& pipeline, bool mean = false) {
    const std::string term = R"({"type": "distortion", "nodes": "tip", "mean": )" + to_text(mean) + "}";
    return test::make_response<dim>(TermList::objective, term, pipeline.setup.context());
  }
  static std::unique_ptr<Response<dim>> flatness(const Case& pipeline, const char* nodes) {
    const std::string term = R"({"type": "distortion", "measure": "flatness", "axis": "x", "nodes": ")" +
                             std::string(nodes) + "\"}";
    return test::make_response<dim>(TermList::objective, term, pipeline.setup.context());
  }
  static std::optional<SumOfSquares<dim>> squares(const std::unique_ptr<Response<dim>>& distortion) {
    return distortion->squares(TermScaling::current);
  }
  static ProcessResult result_of(const std::vector<double>& displacement) {
    ProcessResult result;
    result.displacement = displacement;
    return result;
  }
  /// u_a = c_a + sum_b g_ab x_b on the owned nodes.
  static std::vector<double> linear_displacement(const Grid<dim>& grid) {
    std::vector<double> result;
    grid.owned_nodes().for_each([&](const Index<dim>& index, std::int64_t) {
      for (int a = 0; a < dim; ++a) {
        double u = 0.3 - 0.7 * a;
        for (int b = 0; b < dim; ++b) u += (0.2 + 0.5 * a - 0.4 * b * b) * grid.node_position(index)[b];
        result.push_back(u);
      }
    });
    return result;
  }
  static std::vector<double> rough_displacement(const Grid<dim>& grid) {
    std::vector<double> result;
    grid.owned_nodes().for_each([&](const Index<dim>& index, std::int64_t) {
      for (int a = 0; a < dim; ++a)
        result.push_back(test::noise(grid.all_nodes().offset(index), 4 + a) - 0.4);
    });
    return result;
  }
};
TYPED_TEST_SUITE(DistortionFunctionalsTest, test::Dimensions);

double sum_of_squares(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

/// The tip is a face across x, the top one across the last axis: a function less than in the box.
TYPED_TEST(DistortionFunctionalsTest, DependentFunctionsAreDropped) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case pipeline;
  EXPECT_EQ(this->squares(this->displacement(pipeline))->count, Dim * Dim);
  EXPECT_EQ(this->squares(this->flatness(pipeline, "top"))->count, Dim - 1);
}

TYPED_TEST(DistortionFunctionalsTest, LinearDisplacementsLeaveNoRest) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case pipeline;
  const auto state = pipeline.run(pipeline.wavy_design());
  const ProcessResult linear = this->result_of(this->linear_displacement(pipeline.setup.grid));
  const StageResults<Dim> moved{state.time, state.densities, linear};
  for (const auto& distortion : {this->displacement(pipeline, false), this->displacement(pipeline, true),
                                 this->flatness(pipeline, "top")}) {
    const double whole = distortion->values(moved)[0];
    EXPECT_GT(whole, 0.01);
    const auto squares = this->squares(distortion);
    EXPECT_NEAR(sum_of_squares(squares->functionals->values(moved)), whole, 1e-12 * whole);
  }
}

/// What they leave of rough displacements is what a fit of constant and slopes leaves. On a face of the grid
/// the centred coordinates are orthogonal, so that each slope is a fit of its own.
TYPED_TEST(DistortionFunctionalsTest, TheRestIsThatOfALinearFit) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case pipeline;
  const auto state = pipeline.run(pipeline.wavy_design());
  const Part<Dim>& part = pipeline.setup.part;
  const Grid<Dim>& grid = part.grid();
  const NodeSet& tip = pipeline.setup.node_sets.at("tip");
  const ProcessResult rough = this->result_of(this->rough_displacement(grid));
  const StageResults<Dim> moved{state.time, state.densities, rough};

  std::vector<double> member(static_cast<std::size_t>(grid.owned_nodes().count()), 0.0);
  for (const int node : tip.owned) member[node] = 1.0;
  const auto members = test::whole_node_field<Dim>(grid, member);
  const auto u = test::whole_node_field<Dim>(grid, rough.displacement, Dim);
  std::vector<std::vector<double>> columns(2 * Dim);  // coordinates, displacements
  grid.all_nodes().for_each([&](const Index<Dim>& index, std::int64_t node) {
    if (members[node] == 0.0) return;
    for (int a = 0; a < Dim; ++a) {
      columns[a].push_back(grid.node_position(index)[a]);
      columns[Dim + a].push_back(u[node * Dim + a]);
    }
  });
  double whole = 0.0;
  for (int a = 0; a < Dim; ++a) whole += sum_of_squares(columns[Dim + a]);
  for (auto& column : columns) {
    const double mean =
        std::accumulate(column.begin(), column.end(), 0.0) / static_cast<double>(column.size());
    for (double& value : column) value -= mean;
  }
  double rest = 0.0;
  for (int a = 0; a < Dim; ++a) {
    std::vector<double> left = columns[Dim + a];
    for (int b = 1; b < Dim; ++b) {
      const auto& x = columns[b];
      const double slope = std::inner_product(x.begin(), x.end(), left.begin(), 0.0) / sum_of_squares(x);
      for (std::size_t i = 0; i < left.size(); ++i) left[i] -= slope * x[i];
    }
    rest += sum_of_squares(left);
  }
  const auto squares = this->squares(this->displacement(pipeline));
  EXPECT_GT(rest, 0.1 * whole);
  EXPECT_NEAR(whole - sum_of_squares(squares->functionals->values(moved)), rest, 1e-11 * whole);
  EXPECT_FALSE(squares->complete);
}

TYPED_TEST(DistortionFunctionalsTest, FewNodesLeaveNothing) {
  constexpr int Dim = TypeParam::value;
  typename TestFixture::Case pipeline(Settings{{"node_sets.tip.samples", "2"}});
  const auto functionals = this->squares(this->displacement(pipeline));
  EXPECT_EQ(functionals->count, 2 * Dim);
  EXPECT_TRUE(functionals->complete);
  EXPECT_EQ(this->squares(this->flatness(pipeline, "tip"))->count, 1);
}

/// Through the whole pipeline, on the plate and after the release.
TYPED_TEST(DistortionFunctionalsTest, GradientsAgreeWithDifferences) {
  for (const Settings& settings :
       {squares_of_all, squares_after_release + test::on_clamped_substrate<TypeParam::value>()}) {
    typename TestFixture::Case pipeline(settings);
    const auto responses = pipeline.problem.responses_and_functionals();
    const std::size_t first = pipeline.problem.responses().size();
    ASSERT_GT(responses.size(), first);
    const Design design = pipeline.wavy_point(), direction = pipeline.direction_at(design);
    const auto state = pipeline.run(design);
    const auto functionals = responses.subspan(first);
    const auto flat_values = [&](const StageResults<TypeParam::value>& at) {
      std::vector<double> result;
      for (const auto& list : pipeline.pipeline.values(functionals, at))
        result.insert(result.end(), list.begin(), list.end());
      return result;
    };
    std::vector<GradientRow> rows;
    for (std::size_t r = 0; r < functionals.size(); ++r)
      for (std::size_t k = 0; k < functionals[r]->values(state).size(); ++k)
        rows.push_back({{static_cast<int>(r), static_cast<int>(k), 1.0}});
    const auto gradients = pipeline.pipeline.gradients(functionals, state, rows);
    const auto expected = test::central_differences(
        [&](double step) { return flat_values(pipeline.run(test::moved(design, step, direction))); }, 2e-3);
    ASSERT_EQ(gradients.size(), expected.size());
    const double largest = std::abs(*std::max_element(
        expected.begin(), expected.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
    for (std::size_t row = 0; row < rows.size(); ++row)
      EXPECT_NEAR(test::dot(gradients[row], direction), expected[row], 1e-6 * largest) << row;
  }
}

/// Residuals and rest together are the objective: so are their gradients.
TYPED_TEST(DistortionFunctionalsTest, ResidualsAndRestMakeUpTheObjective) {
  typename TestFixture::Case squared(squares_of_all),
      plain(squares_of_all + Settings{{"objective.0.least_squares", "false"},
                                      {"objective.1.least_squares", "false"},
                                      {"objective.2.least_squares", "false"}});
  const auto design = squared.wavy_design();
  const auto gradients_of = [&](auto& pipeline, ProblemValues& values) {
    const auto state = pipeline.run(design);
    values = pipeline.problem.evaluate(pipeline.pipeline, state);
    return pipeline.problem.gradients(pipeline.pipeline, state, values);
  };
  ProblemValues values, plain_values;
  const ProblemGradients found = gradients_of(squared, values), expected = gradients_of(plain, plain_values);
  constexpr std::size_t components = TypeParam::value;
  ASSERT_EQ(found.residuals.size(), 2 * components * components + components - 1);
  EXPECT_TRUE(expected.residuals.empty());
  EXPECT_EQ(values.functionals[0].size(), components * components);
  EXPECT_TRUE(values.functionals[3].empty());
  std::vector<double> total = found.objective.field;
  double squares = 0.0;
  for (const ProblemRow& residual : found.residuals) {
    squares += residual.value * residual.value;
    for (std::size_t e = 0; e < total.size(); ++e)
      total[e] += 2.0 * residual.value * residual.gradient.field[e];
  }
  EXPECT_LT(squares, values.scaled[0] + values.scaled[1] + values.scaled[2]);
  EXPECT_GT(squares, 0.5 * (values.scaled[0] + values.scaled[1]));
  EXPECT_LT(test::relative_difference(total, expected.objective.field), 1e-8);
  ASSERT_EQ(found.constraints.size(), expected.constraints.size());
  for (std::size_t row = 0; row < found.constraints.size(); ++row)
    EXPECT_EQ(found.constraints[row].value, expected.constraints[row].value);
  EXPECT_NEAR(values.merit, plain_values.merit, 1e-12 * std::abs(values.merit));
}

TYPED_TEST(DistortionFunctionalsTest, NamesSayTheTerm) {
  typename TestFixture::Case pipeline(squares_of_all);
  const std::size_t configured = pipeline.problem.responses().size();
  EXPECT_EQ(pipeline.problem.component_name(configured, 1), "objective_0_functional_1");
  EXPECT_EQ(pipeline.problem.component_name(configured + 2, 0), "objective_2_functional_0");
  EXPECT_EQ(pipeline.problem.component_name(configured - 1, 0), "constraint_1_0");
}

}  // namespace
}  // namespace fabseq
