// SPDX-License-Identifier: MIT
/// Limits of a machine (docs/formulation.md 13.2): values against the formulas on gathered fields, element by
/// element; they bound what the exact checks count; rows.
#include "fabseq/machine/least_rotation.h"
#include "fabseq/machine/torch.h"
#include "support/pipeline_case.h"
#include "support/refusal.h"
#include "support/response.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace fabseq {
namespace {

double excess(double x) { return std::log2(1.0 + std::log1p(std::exp(x)) / std::numbers::ln2); }

template <class T>
class MachineLimitsTest : public testing::Test {
 protected:
  static constexpr int dim = T::value;
  using Case = test::PipelineCase<dim>;

  static Settings with_tool(const std::string& tool) { return {{"tool", tool}}; }
  static std::unique_ptr<Response<dim>> limit(const Case& pipeline, const std::string& term) {
    return test::make_response<dim>(TermList::constraints, term, pipeline.setup.context());
  }
  static std::vector<double> whole(const Case& pipeline, std::span<const double> field) {
    return test::whole_part_field<dim>(pipeline.setup.part, field);
  }
  /// Regularized direction of grad t at each element of the grid.
  static std::vector<Point<dim>> directions(const Case& pipeline, const StageResults<dim>& state) {
    std::vector<Point<dim>> result;
    std::vector<std::vector<double>> components;
    for (int axis = 0; axis < dim; ++axis) {
      std::vector<double> component;
      for (std::size_t e = 0; e * dim < state.time->gradient.size(); ++e)
        component.push_back(state.time->gradient[e * dim + axis]);
      components.push_back(whole(pipeline, component));
    }
    const double regularization = gradient_regularization(pipeline.setup.characteristic_length);
    for (std::size_t e = 0; e < components[0].size(); ++e) {
      Point<dim> vector;
      double square = regularization;
      for (int axis = 0; axis < dim; ++axis) square += components[axis][e] * components[axis][e];
      for (int axis = 0; axis < dim; ++axis) vector[axis] = components[axis][e] / std::sqrt(square);
      result.push_back(vector);
    }
    return result;
  }
  static std::vector<double> density(const Case& pipeline) {
    return whole(pipeline, pipeline.setup.part.part_density());
  }
  static double part_share(const Case& pipeline) {
    return pipeline.setup.grid.element_volume() / pipeline.setup.part.volume();
  }
};
TYPED_TEST_SUITE(MachineLimitsTest, test::Dimensions);

TYPED_TEST(MachineLimitsTest, TiltIsTheShareBeyondSmoothlyCounted) {
  constexpr int Dim = TypeParam::value;
  constexpr double degree = std::numbers::pi / 180.0;
  typename TestFixture::Case pipeline(this->with_tool(R"({"max_tilt": 50})"));
  const auto state = pipeline.run(pipeline.wavy_design());
  const double value = this->limit(pipeline, R"({"type": "tilt", "width": 6})")->values(state)[0];
  const auto directions = this->directions(pipeline, state);
  const auto density = this->density(pipeline);
  const double epsilon = 0.25 * (std::cos(47 * degree) - std::cos(53 * degree));
  double expected = 0.0, beyond = 0.0;
  for (std::size_t e = 0; e < density.size(); ++e) {
    const double cosine = directions[e][Dim - 1];
    expected += density[e] * excess((std::cos(50 * degree) - cosine) / epsilon);
    beyond += density[e] * (cosine < std::cos(50 * degree) ? 1.0 : 0.0);
  }
  EXPECT_NEAR(value, expected * this->part_share(pipeline), 1e-11 * value);
  EXPECT_GT(beyond, 0.0);
  EXPECT_GT(value, beyond * this->part_share(pipeline));
}

TYPED_TEST(MachineLimitsTest, LocalThicknessCountsThickAndThin) {
  typename TestFixture::Case pipeline(this->with_tool(R"({"thickness": [0.7, 1.3]})"));
  const auto state = pipeline.run(pipeline.wavy_design());
  const auto values = this->limit(pipeline, R"({"type": "local_thickness", "width": 0.08})")->values(state);
  const auto density = this->density(pipeline);
  const double regularization = gradient_regularization(pipeline.setup.characteristic_length);
  std::vector<double> thickness;
  for (std::size_t e = 0; e < pipeline.setup.part.part_density().size(); ++e) {
    double square = regularization, duration = 0.0;
    for (int axis = 0; axis < this->dim; ++axis)
      square += std::pow(state.time->gradient[e * this->dim + axis], 2);
    for (int j = 0; j < state.densities->count(); ++j)
      duration += state.densities->layer[j][e] *
                  (state.densities->time_points[j + 1] - state.densities->time_points[j]);
    thickness.push_back(duration / pipeline.setup.part.part_density()[e] / std::sqrt(square));
  }
  const auto all = this->whole(pipeline, thickness);
  double thick = 0.0, thin = 0.0;
  for (std::size_t e = 0; e < all.size(); ++e) {
    if (density[e] == 0.0) continue;
    thick += density[e] * excess(std::log(all[e] / (1.3 * 0.5)) / 0.02);  // the target is 0.5
    thin += density[e] * excess(std::log(0.7 * 0.5 / all[e]) / 0.02);
  }
  EXPECT_NEAR(values[0], thick * this->part_share(pipeline), 1e-11 * values[0]);
  EXPECT_NEAR(values[1], thin * this->part_share(pipeline), 1e-11 * values[1]);
}

/// A margin counts as a narrower limit of the machine would.
TYPED_TEST(MachineLimitsTest, MarginsNarrowTheLimits) {
  const auto values = [this](const std::string& tool, const std::string& term) {
    typename TestFixture::Case pipeline(this->with_tool(tool));
    const auto state = pipeline.run(pipeline.wavy_design());
    return this->limit(pipeline, term)->values(state);
  };
  EXPECT_DOUBLE_EQ(values(R"({"max_tilt": 53})", R"({"type": "tilt", "margin": 3})")[0],
                   values(R"({"max_tilt": 50})", R"({"type": "tilt"})")[0]);
  const auto with_margin =
      values(R"({"thickness": [0.7, 1.3]})", R"({"type": "local_thickness", "margin": 0.1})");
  const auto narrower = values(R"({"thickness": [0.77, 1.17]})", R"({"type": "local_thickness"})");
  for (int side = 0; side < 2; ++side) EXPECT_NEAR(with_margin[side], narrower[side], 1e-12 * narrower[side]);
}

/// Fields are interpolated by hats of the elements' spacing around all centres.
template <int Dim>
double clearance(const Grid<Dim>& grid, const ToolSettings& tool, int samples, double layer,
                 const std::vector<double>& density, const std::vector<double>& time,
                 const std::vector<double>& standing, const std::vector<Point<Dim>>& axes) {
  Point<Dim> up{};
  up[Dim - 1] = 1.0;
  const auto& size = grid.domain().size;
  const double diagonal = std::sqrt(dot(size, size));
  const std::vector<Point<Dim>> points = torch_samples<Dim>(tool, up, diagonal, samples);
  double total = 0.0;
  grid.all_elements().for_each([&](const Index<Dim>& x, std::int64_t e) {
    if (density[e] == 0.0) return;
    const LeastRotation<Dim> rotation(up, axes[e]);
    for (const Point<Dim>& point : points) {
      const Point<Dim> offset = rotation.apply(point);
      grid.all_elements().for_each([&](const Index<Dim>& y, std::int64_t c) {
        double weight = standing[c];
        for (int axis = 0; axis < Dim; ++axis)
          weight *= std::max(0.0, 1.0 - std::abs(y[axis] - x[axis] - offset[axis] / grid.spacing()[axis]));
        if (weight > 0.0)
          total += density[e] * weight * excess((time[e] - time[c] - 0.3 * layer) / (0.2 * layer));
      });
    }
  });
  return total / samples;
}

TYPED_TEST(MachineLimitsTest, ClearanceCountsWhatStandsInTheTorch) {
  constexpr int Dim = TypeParam::value;
  for (const bool fixed : {true, false}) {
    Settings settings =
        this->with_tool(R"({"profile": [[0.1, 0.1], [0.4, 0.6], [1.5, 0.6]], "clearance": 0.05})");
    if (fixed) settings.push_back({"tool.axis", Dim == 2 ? "[0.3, 1]" : "[0.3, 0.1, 1]"});
    for (const auto& setting : test::on_clamped_substrate<Dim>()) settings.push_back(setting);
    typename TestFixture::Case pipeline(settings);
    const auto state = pipeline.run(pipeline.wavy_design());
    const double value =
        this->limit(pipeline, R"({"type": "tool_clearance", "samples": 30, "delay": 0.3, "sharpness": 0.2})")
            ->values(state)[0];
    const auto density = this->density(pipeline);
    auto time = this->whole(pipeline, state.time->time), standing = density;
    std::vector<double> substrate(pipeline.setup.part.substrate().elements().begin(),
                                  pipeline.setup.part.substrate().elements().end());
    substrate = test::whole_element_field<Dim>(pipeline.setup.grid, substrate);
    for (std::size_t e = 0; e < substrate.size(); ++e)
      if (substrate[e] != 0.0) time[e] = -1.0, standing[e] = 1.0;
    auto axes = this->directions(pipeline, state);
    const ToolSettings& tool = pipeline.config.tool;
    if (fixed) {
      Point<Dim> axis;
      std::copy_n(tool.axis.begin(), Dim, axis.begin());
      const double length = std::sqrt(dot(axis, axis));
      for (double& entry : axis) entry /= length;
      std::fill(axes.begin(), axes.end(), axis);
    }
    const double expected = clearance<Dim>(pipeline.setup.grid, tool, 30, 1.0 / state.densities->count(),
                                           density, time, standing, axes) *
                            this->part_share(pipeline);
    EXPECT_GT(value, 1e-3);
    EXPECT_NEAR(value, expected, 1e-10 * value) << fixed;
  }
}

TEST(MachineLimitsTest, RowsBoundLogarithms) {
  test::PipelineCase<2> pipeline(Settings{{"tool", R"({"max_tilt": 50})"}});
  const auto tilt = test::make_response<2>(TermList::constraints, R"({"type": "tilt", "limit": 0.01})",
                                           pipeline.setup.context());
  const ConstraintRow row = tilt->rows(0.5)[0];
  EXPECT_DOUBLE_EQ(row.violation(0.01), std::numbers::ln2);
  EXPECT_DOUBLE_EQ(row.violation(0.005), 0.0);
  EXPECT_DOUBLE_EQ(row.slope(0.02), 50.0);
  EXPECT_LT(row.violation(0.0), -200.0);
}

/// "<message>; allowed: ..." of a config with this constraint and torch.
std::string refused(const std::string& constraint, const std::string& tool, Settings settings = {}) {
  settings.push_back({"constraints", "[" + constraint + "]"});
  settings.push_back({"tool", tool});
  return test::refusal([&] { test::gallows_config<2>(settings); });
}

TEST(MachineLimitsTest, RefusesWhatHasNoMeaning) {
  EXPECT_EQ(
      refused(R"({"type": "tool_clearance"})", "{}"),
      "/tool/profile: found [] with a constraint tool_clearance; allowed: pairs of a height and a radius");
  EXPECT_EQ(
      refused(R"({"type": "tilt"})", R"({"axis": [0, 1]})"),
      R"(/constraints/0/type: found "tilt" with a fixed tool.axis; allowed: "tilt" with tool.axis "normal")");
  EXPECT_EQ(refused(R"({"type": "tilt"})", "{}"),
            "/tool/max_tilt: found 180.0 with a constraint tilt; allowed: less than 180");
  EXPECT_EQ(refused(R"({"type": "local_thickness"})", "{}"),
            R"(/constraints/0/type: found "local_thickness" without a target; allowed: a constraint )"
            "layer_thickness, whose target it is measured by");
  EXPECT_EQ(refused(R"({"type": "tilt", "margin": 40})", R"({"max_tilt": 40})"),
            "/constraints/0/margin: found 40.0; allowed: less than tool.max_tilt, 40.0");
  EXPECT_EQ(
      refused(R"({"type": "local_thickness", "margin": 0.2})", R"({"thickness": [0.9, 1.2]})"),
      "/constraints/0/margin: found 0.2; allowed: one that leaves a part of the range of tool.thickness");
}

}  // namespace
}  // namespace fabseq
