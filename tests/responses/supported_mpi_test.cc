// SPDX-License-Identifier: MIT
/// The constraint supported (docs/formulation.md 13.2): its value by brute force on gathered fields; no less
/// than the share of elements that the exact check finds; its derivatives.
#include "fabseq/machine/build_direction.h"
#include "fabseq/machine/hanging.h"
#include "support/pipeline_case.h"
#include "support/refusal.h"
#include "support/response.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace fabseq {
namespace {

using test::operator+;

double excess(double x) { return std::log2(1.0 + std::log1p(std::exp(x)) / std::numbers::ln2); }

const std::string guided = R"({"type": "guided", "filter_radius": 0, "stretch": [0.4, 2.5]})";

template <class T>
class SupportedTest : public testing::Test {
 protected:
  static constexpr int dim = T::value;
  using Case = test::PipelineCase<dim>;

  static Settings curved(const std::string& sequence, double bead = 0.0) {
    Settings result = {{"tool", R"({"bead_width": )" + std::to_string(bead) + "}"}};
    if (!sequence.empty()) result.push_back({"sequence", sequence});
    return result;
  }
  static Settings multi_planar(double bead = 0.0) {
    Settings result = curved("", bead);
    result.push_back(
        {"layers",
         std::string(
             R"({"type": "multi_planar", "subparts": 3, "thickness": 0.4, "angle_bounds": [-3, 3], "angles": )") +
             (dim == 2 ? "[[1.3], [0.4], [2.0]]}" : "[[1.3, 0.4], [0.6, 0.3], [1.1, 2.5]]}")});
    result.push_back({"projection", "{}"});
    result.push_back({"objective", R"([{"type": "distortion", "nodes": "tip", "least_squares": false}])"});
    result.push_back({"constraints", "[]"});
    return result;
  }
  static std::unique_ptr<Response<dim>> supported(const Case& pipeline, const std::string& keys = "") {
    return test::make_response<dim>(TermList::constraints, R"({"type": "supported")" + keys + "}",
                                    pipeline.setup.context());
  }
  static Design some_design(const Case& pipeline, int salt) {
    const bool tilted = pipeline.config.sequence.kind->name == "guided";
    return {pipeline.noise_of_variables(tilted ? -0.9 : 0.05, 0.9, salt),
            pipeline.setup.layers->variables().start};
  }

  /// Share of the part's elements that hang, of binary layers.
  static double exact_share(Case& pipeline, const Design& design) {
    const auto state = pipeline.pipeline.run(design, pipeline.setup.layers->traits().first_beta, true);
    const auto layers = pipeline.setup.layers->make(design.layer_variables, 1.0, true, {});
    const std::vector<double> index = layers->layer_index(state.time->time, *state.densities);
    const std::vector<double> direction = build_direction<dim>(state.time->gradient, *state.densities, index);
    const std::vector<double> marks =
        hanging_elements<dim>(pipeline.setup.part, direction, index, pipeline.config.tool.bead_width);
    double count = 0.0;
    for (const double mark : marks) count += mark;
    return sum(PETSC_COMM_WORLD, count) / static_cast<double>(pipeline.setup.part.count());
  }
};
TYPED_TEST_SUITE(SupportedTest, test::Dimensions);

/// The formula, over all pairs of elements of the grid and those below the plate.
template <int Dim>
double count_of(const Setup<Dim>& setup, const StageResults<Dim>& state, double bead_width,
                double sharpness) {
  const Grid<Dim>& grid = setup.grid;
  const auto whole = [&](const std::vector<double>& field) {
    return test::whole_part_field<Dim>(setup.part, field);
  };
  const auto in_part = whole(std::vector<double>(setup.part.elements().size(), 1.0));
  const auto substrate =
      test::whole_element_field<Dim>(grid, std::vector<double>(setup.part.substrate().elements().begin(),
                                                               setup.part.substrate().elements().end()));
  const auto time = whole(state.time->time);
  std::vector<std::vector<double>> gradient;
  for (int axis = 0; axis < Dim; ++axis) {
    std::vector<double> component;
    for (std::size_t e = 0; e < state.time->time.size(); ++e)
      component.push_back(state.time->gradient[e * Dim + axis]);
    gradient.push_back(whole(component));
  }
  const Point<Dim>& h = grid.spacing();
  const double least = *std::min_element(h.begin(), h.end()), diagonal = std::sqrt(dot(h, h));
  const double width = bead_width > 0.0 ? bead_width : 2.0 * grid.largest_spacing();
  const double radius = std::max(0.5 * width, 0.5 * diagonal);
  const SubParts& sub_parts = state.densities->sub_parts;
  const int parts = std::max(1, sub_parts.count());

  IndexBox<Dim> around = grid.all_elements();  // with what lies below the plate
  for (int axis = 0; axis < Dim; ++axis) {
    around.start[axis] -= 8;
    around.size[axis] += 16;
  }
  double steps = 0.0;  // that may lead to a footing
  around.for_each([&](const Index<Dim>& step, std::int64_t) {
    double square = 0.0;
    for (int axis = 0; axis < Dim; ++axis) square += std::pow(step[axis] * h[axis], 2);
    if (square > 0.0 && square <= (diagonal * diagonal + radius * radius) * (1.0 + 1e-6)) steps += 0.5;
  });

  double total = 0.0;
  grid.all_elements().for_each([&](const Index<Dim>& x, std::int64_t e) {
    if (in_part[e] == 0.0) return;
    double square = gradient_regularization(setup.characteristic_length);
    for (int axis = 0; axis < Dim; ++axis) square += std::pow(gradient[axis][e], 2);
    const double clock = std::sqrt(square) * least * sharpness;
    for (int i = 0; i < parts; ++i) {
      const bool first = sub_parts.count() == 0 || i == 0, last = sub_parts.count() == 0 || i + 1 == parts;
      Point<Dim> a;
      for (int axis = 0; axis < Dim; ++axis)
        a[axis] = sub_parts.count() == 0 ? gradient[axis][e] / std::sqrt(square)
                                         : sub_parts.directions[static_cast<std::size_t>(i) * Dim + axis];
      double support = 0.0;
      around.for_each([&](const Index<Dim>& y, std::int64_t) {
        const bool inside = grid.all_elements().contains(y);
        const std::int64_t c = inside ? grid.all_elements().offset(y) : 0;
        const bool stands = y[Dim - 1] < 0 || (inside && substrate[c] != 0.0);
        if (!stands && !(inside && in_part[c] != 0.0)) return;
        double along = 0.0, offset_square = 0.0, extent = 0.0, deepest = 0.0;
        bool next = true;
        for (int axis = 0; axis < Dim; ++axis) {
          const double offset = (y[axis] - x[axis]) * h[axis], root = std::hypot(a[axis], 0.05);
          along -= offset * a[axis];
          offset_square += offset * offset;
          extent += root * h[axis];
          deepest += (root - 0.05) * h[axis];
          next = next && std::abs(y[axis] - x[axis]) <= 1;
        }
        if (offset_square == 0.0 || offset_square > (diagonal * diagonal + radius * radius) * (1.0 + 1e-6))
          return;
        const double unit = 0.25 * sharpness * least;
        double misses = std::exp((0.5 * extent - along) / unit) +
                        std::exp((offset_square - along * along - radius * radius) / (2.0 * radius * unit));
        if (!next) misses += std::exp((along - deepest) / unit);
        const bool timeless = stands || (sub_parts.count() > 0 && last);
        if (!timeless)
          misses +=
              std::exp((time[c] - (sub_parts.count() == 0 ? time[e] : sub_parts.timestamps[i])) / clock);
        support += 1.0 / misses;
      });
      double bracket = support / (steps + 1.0) + std::exp(-100.0);
      if (!first) bracket += std::exp((sub_parts.timestamps[i - 1] - time[e]) / clock);
      if (!last) bracket += std::exp((time[e] - sub_parts.timestamps[i]) / clock);
      total += excess(std::log((sub_parts.count() == 0 ? 1.0 : 3.0) / bracket));
    }
  });
  return total / static_cast<double>(setup.part.count());
}

TYPED_TEST(SupportedTest, IsTheFormula) {
  constexpr int Dim = TypeParam::value;
  const double bead = Dim == 2 ? 1.1 : 1.9;
  for (const Settings& settings :
       {this->curved(guided), this->curved(guided, bead) + test::on_clamped_substrate<Dim>(),
        this->curved(""), this->multi_planar(bead)}) {
    typename TestFixture::Case pipeline(settings);
    const auto state = pipeline.run(this->some_design(pipeline, 1));
    const double value = this->supported(pipeline, R"(, "sharpness": 0.1)")->values(state)[0];
    const double expected = count_of<Dim>(pipeline.setup, state, pipeline.config.tool.bead_width, 0.1);
    EXPECT_GT(value, 1e-6);
    EXPECT_NEAR(value, expected, 1e-9 * expected);
  }
}

TYPED_TEST(SupportedTest, IsNoLessThanTheShareThatHangs) {
  constexpr int Dim = TypeParam::value;
  const double bead = Dim == 2 ? 1.1 : 1.9;
  int hanging = 0;
  for (const Settings& settings :
       {this->curved(guided), this->curved(guided, bead) + test::on_clamped_substrate<Dim>(),
        this->curved(""), this->multi_planar(), this->multi_planar(bead),
        this->curved(guided) + Settings{{"build_plate", "\"x-\""}}}) {
    typename TestFixture::Case pipeline(settings);
    const auto response = this->supported(pipeline);
    for (int salt = 0; salt < 6; ++salt) {
      const Design design = this->some_design(pipeline, salt);
      const double value = response->values(pipeline.run(design))[0];
      const double share = this->exact_share(pipeline, design);
      EXPECT_GE(value, share * (1.0 - 1e-9));
      hanging += share > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(hanging, 6);
}

/// Where every element stands on others the count is far below one element's share, and the limit, by
/// default half of that, is met.
TYPED_TEST(SupportedTest, IsNextToNothingOfUprightLayersOfABlock) {
  constexpr int Dim = TypeParam::value;
  Settings settings = this->curved(R"({"type": "guided", "initial": "planar"})");
  settings.push_back({"part", Dim == 2 ? R"({"box": {"min": [0, 0], "max": [3.5, 1.5]}})"
                                       : R"({"box": {"min": [0, 0, 0], "max": [2, 0.9, 2.5]}})"});
  typename TestFixture::Case pipeline(settings);
  const auto response = this->supported(pipeline);
  const auto state = pipeline.run(Design{pipeline.pipeline.sequence().initial_design(), {}});
  EXPECT_LT(response->values(state)[0], 1e-4 / static_cast<double>(pipeline.setup.part.count()));
  const ConstraintRow row = response->rows(0.5)[0];
  EXPECT_TRUE(row.logarithmic);
  EXPECT_DOUBLE_EQ(row.bound, 0.25 / static_cast<double>(pipeline.setup.part.count()));
  EXPECT_DOUBLE_EQ(this->supported(pipeline, R"(, "limit": 0.01)")->rows(1.0)[0].bound, 0.01);
}

TYPED_TEST(SupportedTest, DerivativesAgreeWithDifferences) {
  constexpr int Dim = TypeParam::value;
  const double bead = Dim == 2 ? 1.1 : 1.9;
  for (Settings settings :
       {this->curved(guided), this->curved(guided, bead) + test::on_clamped_substrate<Dim>(),
        this->curved(""), this->multi_planar(bead)}) {
    settings.push_back({"constraints", R"([{"type": "supported", "sharpness": 0.2}])"});
    typename TestFixture::Case pipeline(settings);
    const auto& responses = pipeline.problem.responses();
    const int last = static_cast<int>(responses.size()) - 1;
    const Design design = this->some_design(pipeline, 2);
    Design direction{pipeline.noise_of_variables(-0.5, 0.5, 9), design.layer_variables};
    for (std::size_t j = 0; j < direction.layer_variables.size(); ++j)
      direction.layer_variables[j] = test::noise(static_cast<std::int64_t>(j), 8) - 0.5;
    const auto state = pipeline.run(design);
    const std::vector<GradientRow> rows = {{{last, 0, 1.0}}};
    const Design gradient = pipeline.pipeline.gradients(responses, state, rows)[0];
    const double expected = test::central_difference(
        [&](double step) {
          return responses[last]->values(pipeline.run(test::moved(design, step, direction)))[0];
        },
        2e-4);
    EXPECT_NE(expected, 0.0);
    EXPECT_NEAR(test::dot(gradient, direction), expected, 1e-5 * std::abs(expected));
  }
}

TEST(SupportedTest, NeedsAGradientOfTheTime) {
  EXPECT_EQ(
      test::refusal([] {
        test::gallows_config<2>({{"sequence", R"({"type": "direct"})"},
                                 {"objective", R"([{"type": "distortion", "nodes": "tip"}])"},
                                 {"constraints", R"([{"type": "supported"}])"}});
      }),
      "/constraints/0/type: found \"supported\" with sequence type \"direct\" and location \"elements\", "
      "for which the gradient of the pseudo-time is not defined; allowed: this type with sequence type "
      "heat, guided, planar, or direct with location nodes");
}

}  // namespace
}  // namespace fabseq
