// SPDX-License-Identifier: MIT
/// Every response: its values against the formulas of formulation 5 to 7 on gathered fields, its gradient
/// through the whole pipeline against differences.
#include "fabseq/base/hdf5.h"
#include "support/io_support.h"
#include "support/response_formulas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace fabseq {
namespace {

std::vector<double> flat(const std::vector<std::vector<double>>& values) {
  std::vector<double> result;
  for (const auto& list : values) result.insert(result.end(), list.begin(), list.end());
  return result;
}

template <int Dim>
void expect_formulas(test::PipelineCase<Dim>& pipeline, const StageResults<Dim>& state) {
  const auto expected = test::Formulas<Dim>(pipeline, state).values();
  const auto values = pipeline.pipeline.values(pipeline.problem.responses(), state);
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t r = 0; r < values.size(); ++r)
    EXPECT_LT(test::relative_difference(values[r], expected[r]), 1e-10)
        << pipeline.problem.component_name(r, 0);
}

template <int Dim>
void expect_exact_gradients(test::PipelineCase<Dim>& pipeline, const Design& design,
                            const Design& direction) {
  const auto& responses = pipeline.problem.responses();
  const auto values = [&](const StageResults<Dim>& state) {
    return pipeline.pipeline.values(responses, state);
  };
  const auto state = pipeline.run(design);
  std::vector<GradientRow> rows;
  const auto components = values(state);
  for (std::size_t r = 0; r < components.size(); ++r)
    for (std::size_t c = 0; c < components[r].size(); ++c)
      rows.push_back({{static_cast<int>(r), static_cast<int>(c), 1.0}});
  const auto gradients = pipeline.pipeline.gradients(responses, state, rows);
  const auto expected = test::central_differences(
      [&](double step) { return flat(values(pipeline.run(test::moved(design, step, direction)))); }, 2e-3);
  ASSERT_EQ(gradients.size(), expected.size());
  for (std::size_t row = 0; row < rows.size(); ++row)
    EXPECT_NEAR(test::dot(gradients[row], direction), expected[row], 1e-6 * std::abs(expected[row]) + 1e-12)
        << pipeline.problem.component_name(rows[row][0].response, rows[row][0].component);
}
template <int Dim>
void expect_exact_gradients(test::PipelineCase<Dim>& pipeline) {
  const Design design = pipeline.wavy_point();
  expect_exact_gradients(pipeline, design, pipeline.direction_at(design));
}
/// Field and time points each by itself.
template <int Dim>
void expect_exact_gradients_of_both(const Settings& settings) {
  test::PipelineCase<Dim> pipeline(settings);
  const Design design = pipeline.wavy_point(), direction = pipeline.direction_at(design);
  Design field = direction, time_points = direction;
  std::fill(field.layer_variables.begin(), field.layer_variables.end(), 0.0);
  std::fill(time_points.field.begin(), time_points.field.end(), 0.0);
  expect_exact_gradients(pipeline, design, field);
  ASSERT_EQ(time_points.layer_variables.size(), 3u);
  expect_exact_gradients(pipeline, design, time_points);
}

/// The objective of the config, and every constraint there is.
const char* const all_constraints = R"([
  {"type": "layer_thickness", "target": 0.5}, {"type": "deposition_speed"}, {"type": "continuity"},
  {"type": "minimum_layer_volume", "fraction": 0.1}])";
/// Terms that do not ask for |grad t|.
const char* const plain_objective = R"([{"type": "distortion", "nodes": "tip"},
  {"type": "distortion", "measure": "flatness", "nodes": "top", "axis": "x"},
  {"type": "distortion", "measure": "layerwise"}])";
const char* const plain_constraints =
    R"([{"type": "deposition_speed"}, {"type": "continuity"}, {"type": "minimum_layer_volume"}])";

/// A grey part, written by the first rank.
template <int Dim>
void write_grey_part(const std::string& path) {
  if (test::is_first()) {
    const IndexBox<Dim> all{{}, test::odd_domain<Dim>().elements};
    std::vector<double> density;
    std::vector<hsize_t> shape(all.size.rbegin(), all.size.rend());
    all.for_each([&](const Index<Dim>& index, std::int64_t number) {
      const bool there = 2 * index[0] < all.size[0] || 2 * index[Dim - 1] > all.size[Dim - 1];
      density.push_back(there ? 0.4 + 0.6 * test::noise(number) : 0.0);
    });
    const Hdf5File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    const Hdf5Dataspace space(H5Screate_simple(Dim, shape.data(), nullptr));
    const Hdf5Dataset dataset(
        H5Dcreate2(file, "density", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, density.data());
  }
  MPI_Barrier(PETSC_COMM_WORLD);
}
template <int Dim>
Settings grey_part(const std::string& path) {
  write_grey_part<Dim>(path);
  const std::string upper = Dim == 2 ? "[3.5, 1.5]" : "[2, 0.9, 2.5]";
  const std::string tip = Dim == 2 ? "[3.5, 0]" : "[2, 0, 0]";
  const std::string top = Dim == 2 ? "[0, 1.5]" : "[0, 0, 2.5]";
  return {{"part", R"({"voxels": {"file": ")" + path + "\"}}"},
          {"node_sets.tip.box", "{\"min\": " + tip + ", \"max\": " + upper + "}"},
          {"node_sets.top.box", "{\"min\": " + top + ", \"max\": " + upper + "}"}};
}

template <class T>
class ResponsesTest : public testing::Test {};
TYPED_TEST_SUITE(ResponsesTest, test::Dimensions);

TYPED_TEST(ResponsesTest, ValuesFollowTheFormulas) {
  for (const char* void_model : {"absent", "quiet"}) {
    test::PipelineCase<TypeParam::value> pipeline(Settings{{"process.void", void_model}});
    expect_formulas(pipeline, pipeline.run(pipeline.wavy_design()));
  }
}

/// With far more layers than element heights some stay empty.
TYPED_TEST(ResponsesTest, ValuesFollowTheFormulasForEmptyLayers) {
  test::PipelineCase<TypeParam::value> pipeline(Settings{{"layers.count", "20"}});
  const auto state = pipeline.pipeline.run({pipeline.wavy_design(), {}}, 1.0, true);
  int empty = 0;
  for (const auto& layer : state.densities->layer)
    empty += max(PETSC_COMM_WORLD, test::largest(layer)) == 0.0 ? 1 : 0;
  EXPECT_GT(empty, 0);
  expect_formulas(pipeline, state);
}

TYPED_TEST(ResponsesTest, GradientsAgreeWithDifferences) {
  test::PipelineCase<TypeParam::value> absent(Settings{{"sequence.filter_radius", "0.9"}});
  expect_exact_gradients(absent);
  test::PipelineCase<TypeParam::value> quiet(
      Settings{{"process.void", "quiet"}, {"sequence.mass", "lumped"}});
  expect_exact_gradients(quiet);
}

TYPED_TEST(ResponsesTest, GradientsWithVariableTimePointsAgreeWithDifferences) {
  expect_exact_gradients_of_both<TypeParam::value>(
      {{"layers.time_points", "variable"}, {"constraints", all_constraints}});
}

TYPED_TEST(ResponsesTest, GradientsOfTimesOfNodesAgreeWithDifferences) {
  expect_exact_gradients_of_both<TypeParam::value>(
      {{"layers.time_points", "variable"},
       {"constraints", all_constraints},
       {"sequence", R"({"type": "direct", "location": "nodes"})"}});
}

/// On a substrate all of its nodes are at the start; strains turn with the gradient of the pseudo-time.
TYPED_TEST(ResponsesTest, GradientsOfTimesOfNodesOnASubstrateAgreeWithDifferences) {
  using test::operator+;
  constexpr int Dim = TypeParam::value;
  expect_exact_gradients_of_both<Dim>(test::released_and_turning + test::on_clamped_substrate<Dim>() +
                                      Settings{{"layers.time_points", "variable"},
                                               {"constraints", all_constraints},
                                               {"sequence", R"({"type": "direct", "location": "nodes"})"}});
}

TYPED_TEST(ResponsesTest, GradientsOfTimesOfElementsAgreeWithDifferences) {
  expect_exact_gradients_of_both<TypeParam::value>({{"layers.time_points", "variable"},
                                                    {"objective", plain_objective},
                                                    {"constraints", plain_constraints},
                                                    {"sequence", R"({"type": "direct"})"}});
}

TYPED_TEST(ResponsesTest, ValuesFollowTheFormulasAtVariableTimePoints) {
  test::PipelineCase<TypeParam::value> pipeline(Settings{{"layers.time_points", "variable"}});
  const auto state = pipeline.run(pipeline.wavy_point());
  EXPECT_NE(state.densities->time_points[1], 0.25);
  expect_formulas(pipeline, state);
}

/// As a sum over the layer, without its floor; the row is relative to the least volume.
TYPED_TEST(ResponsesTest, LeastVolumeIsAShareOfThePart) {
  test::PipelineCase<TypeParam::value> pipeline(
      Settings{{"constraints", R"([{"type": "minimum_layer_volume", "fraction": 0.15}])"}});
  const auto state = pipeline.run(pipeline.wavy_design());
  const ProblemValues values = pipeline.problem.evaluate(pipeline.pipeline, state);
  const Part<TypeParam::value>& part = pipeline.setup.part;
  double worst = -1.0;
  for (int j = 0; j < 4; ++j) {
    const std::vector<double> ones(state.densities->layer[j].size(), 1.0);
    const double volume = test::dot(state.densities->layer[j], ones) * part.grid().element_volume();
    EXPECT_NEAR(values.constraints[0][j], 0.15 * part.volume() - volume, 1e-12);
    worst = std::max(worst, 1.0 - volume / (0.15 * part.volume()));
  }
  EXPECT_NEAR(values.worst_constraint, worst, 1e-11);
}

TYPED_TEST(ResponsesTest, GradientsOfReleasedPartsWithTurningStrainAgreeWithDifferences) {
  using test::operator+;
  constexpr int Dim = TypeParam::value;
  for (const Settings& settings :
       {test::released_and_turning, test::released_and_turning + Settings{{"process.void", "quiet"}},
        test::released_and_turning + test::on_clamped_substrate<Dim>(),
        test::released_and_turning + test::on_clamped_substrate<Dim>() +
            Settings{{"process.void", "quiet"},
                     {"material.strain_scale", Dim == 2 ? "[1.2, 0.7]" : "[1.2, 0.7, 0.9]"}}}) {
    test::PipelineCase<Dim> pipeline(settings);
    expect_exact_gradients(pipeline);
  }
}

/// Substrate and clamps in the lane engine, and what the reference path makes of them.
TYPED_TEST(ResponsesTest, PathsAgreeOnReleasedPartsOnSubstrates) {
  using test::operator+;
  constexpr int Dim = TypeParam::value;
  for (const char* void_model : {"absent", "quiet"}) {
    const Settings settings = test::released_and_turning + test::on_clamped_substrate<Dim>() +
                              Settings{{"process.void", void_model}};
    test::PipelineCase<Dim> lanes(settings), reference(settings + Settings{{"solver.path", "reference"}});
    const auto values = lanes.pipeline.values(lanes.problem.responses(), lanes.run(lanes.wavy_design()));
    const auto expected =
        reference.pipeline.values(reference.problem.responses(), reference.run(reference.wavy_design()));
    for (std::size_t r = 0; r < values.size(); ++r)
      EXPECT_LT(test::relative_difference(values[r], expected[r]), 1e-7) << r;
  }
}

TYPED_TEST(ResponsesTest, GreyPartsWeighLess) {
  constexpr int Dim = TypeParam::value;
  const test::ScratchDirectory scratch;
  test::PipelineCase<Dim> pipeline(grey_part<Dim>(scratch.file("grey.h5")));
  const Part<Dim>& part = pipeline.setup.part;
  EXPECT_LT(part.volume(), 0.9 * static_cast<double>(part.count()) * pipeline.setup.grid.element_volume());
  const auto state = pipeline.run(pipeline.wavy_design());
  EXPECT_NEAR(part.volume(), test::Formulas<Dim>(pipeline, state).part_volume(), 1e-12);
  expect_formulas(pipeline, state);
  expect_exact_gradients(pipeline);
}

/// Layers below the least volume count the less, the smaller they are; with values and gradients of all the
/// others as before.
TYPED_TEST(ResponsesTest, SmallLayersFadeOutOfTheThicknessConstraint) {
  constexpr int Dim = TypeParam::value;
  test::PipelineCase<Dim> plain, fading(Settings{{"constraints.0.least_volume", "0.99"}});
  const auto state = plain.run(plain.wavy_design());
  const auto thickness = plain.pipeline.values(plain.problem.responses(), state)[6];
  const auto layers = layer_statistics(plain.setup.context(), *state.time, *state.densities);
  const double whole = 0.99 * plain.setup.part.volume() / 4;
  const auto faded = fading.pipeline.values(fading.problem.responses(), fading.run(fading.wavy_design()))[6];
  int small = 0;
  for (int j = 0; j < 4; ++j) {
    const double x = std::min(1.0, layers[j].volume / whole), share = x * x * (3.0 - 2.0 * x);
    EXPECT_NEAR(faded[j] - 1.0, share * (thickness[j] - 1.0), 1e-9);
    small += x < 1.0 ? 1 : 0;
  }
  EXPECT_GT(small, 0);
  EXPECT_LT(small, 4);
  expect_exact_gradients(fading);
}

/// How late the elements after the last layer of some size are; with time points that move, too.
TYPED_TEST(ResponsesTest, NothingIsLaterThanTheLastWholeLayer) {
  constexpr int Dim = TypeParam::value;
  const Settings settings = {{"constraints", R"([{"type": "last_layer", "least_volume": 0.9}])"},
                             {"layers.time_points", "variable"},
                             {"sequence.drain", "0.25"},
                             {"projection.beta", "20"}};
  test::PipelineCase<Dim> pipeline(settings);
  const Design design = pipeline.wavy_point();
  const auto state = pipeline.run(design);
  const auto layers = layer_statistics(pipeline.setup.context(), *state.time, *state.densities);
  int last = 4;
  while (layers[last - 1].volume < 0.9 * pipeline.setup.part.volume() / 4) --last;
  ASSERT_LT(last, 4);
  double total = 0.0;
  for (const double time : state.time->time)
    total += std::pow(std::max(0.0, 4 * (time - state.densities->time_points[last]) + 0.25), 8);
  const double expected = std::pow(sum(PETSC_COMM_WORLD, total), 0.125);
  EXPECT_GT(expected, 0.25);
  EXPECT_NEAR(pipeline.pipeline.values(pipeline.problem.responses(), state)[6][0], expected, 1e-9);
  const ConstraintRow row = pipeline.problem.responses()[6]->rows(1.0).at(0);
  EXPECT_NEAR(row.violation(expected), expected - 0.25, 1e-12);
  expect_exact_gradients_of_both<Dim>(settings);
  // As large as the others, the last layer may end where it does.
  test::PipelineCase<Dim> whole(test::operator+(settings, {{"constraints.0.least_volume", "1e-9"}}));
  EXPECT_EQ(whole.pipeline.values(whole.problem.responses(), whole.run(design))[6][0], 0.0);
}

/// A row is the weighted sum of its components, whatever stages they look at.
TYPED_TEST(ResponsesTest, RowsAreWeightedSums) {
  test::PipelineCase<TypeParam::value> pipeline;
  const auto& responses = pipeline.problem.responses();
  const auto state = pipeline.run(pipeline.wavy_design());
  const GradientRow sum = {{0, 0, 2.0}, {3, 0, -0.5}, {5, 0, 1.5}, {6, 2, 3.0}, {7, 1, -1.0}};
  std::vector<GradientRow> rows = {sum, {}};
  for (const WeightedComponent& term : sum) rows.push_back({{term.response, term.component, 1.0}});
  const auto gradients = pipeline.pipeline.gradients(responses, state, rows);
  std::vector<double> expected(gradients[0].field.size(), 0.0);
  for (std::size_t i = 0; i < sum.size(); ++i)
    for (std::size_t e = 0; e < expected.size(); ++e)
      expected[e] += sum[i].weight * gradients[2 + i].field[e];
  EXPECT_LT(test::relative_difference(gradients[0].field, expected), 1e-9);
  EXPECT_EQ(test::largest(gradients[1].field), 0.0);
}

TYPED_TEST(ResponsesTest, PlanarLayersAreEven) {
  // Planar time over the height: |grad t| = 1 / height everywhere, every layer height / N thick, no variance.
  constexpr int Dim = TypeParam::value;
  test::PipelineCase<Dim> pipeline(Settings{{"sequence", R"({"type": "planar"})"}, {"layers.count", "5"}});
  const double height = Dim == 2 ? 1.5 : 2.5;
  const auto state = pipeline.pipeline.run({}, 1.0, true);
  const auto values = pipeline.pipeline.values(pipeline.problem.responses(), state);
  EXPECT_NEAR(values[4][0], 0.0, 1e-12);
  EXPECT_NEAR(values[5][0], 0.0, 1e-12);
  for (const double thickness : values[6]) EXPECT_NEAR(thickness, height / 5 / 0.5, 1e-7);
}

}  // namespace
}  // namespace fabseq
