// SPDX-License-Identifier: MIT
/// What counts of increments under nominal deposition, by the formula on the whole grid (formulation 4.6).
#include "fabseq/process/deposition.h"
#include "support/process_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fabseq {
namespace {

template <class T>
class DepositionTest : public testing::Test {};
TYPED_TEST_SUITE(DepositionTest, test::Dimensions);

/// w of all nodes in a layer.
template <int Dim>
std::vector<double> expected_weights(const test::ProcessCase<Dim>& process, const LayerDensities& layers,
                                     int j) {
  const Grid<Dim>& grid = process.grid();
  const auto built = test::whole_part_field(process.part(), layers.stage[j]);
  const auto density = test::whole_part_field(process.part(), process.part().part_density());
  const auto& substrate = process.part().substrate().elements();
  const auto stands =
      test::whole_element_field<Dim>(grid, std::vector<double>(substrate.begin(), substrate.end()));
  std::vector<double> missing(static_cast<std::size_t>(grid.all_nodes().count()), 1.0);
  grid.all_elements().for_each([&](const Index<Dim>& element, std::int64_t e) {
    if (density[e] == 0.0 && stands[e] == 0.0) return;
    const double factor = stands[e] != 0.0 ? 0.0 : 1.0 - built[e] / density[e];
    for (int corner = 0; corner < 1 << Dim; ++corner) {
      Index<Dim> node = element;
      for (int axis = 0; axis < Dim; ++axis) node[axis] += corner >> axis & 1;
      missing[grid.all_nodes().offset(node)] *= factor;
    }
  });
  for (double& value : missing) value = 1.0 - value;
  return missing;
}

TYPED_TEST(DepositionTest, WeightsFollowTheFormula) {
  constexpr int Dim = TypeParam::value;
  auto cases = test::void_models<Dim>();
  for (const auto& settings : test::clamped_cases<Dim>()) cases.push_back(settings);
  for (const auto& settings : cases) {
    const test::ProcessCase<Dim> process(settings);
    const LayerDensities layers = process.densities(process.wavy_time(), 5, 12.0);
    const Deposition<Dim> deposition(process.model);
    LaneVector weights;
    const std::vector<BuildStep> steps = steps_of_layers(5);
    spread(deposition.weights(layers, std::span(steps).subspan(1, 3), process.model.nodes),
           process.model.nodes, static_cast<int>(process.grid().owned_nodes().count()), weights);
    for (int lane = 0; lane < 3; ++lane)
      EXPECT_LT(test::relative_difference(test::whole_node_field<Dim>(process.grid(), weights.lane(lane), 1),
                                          expected_weights(process, layers, 1 + lane)),
                1e-14);
  }
}

/// With binary layers a place counts from the layer on that first touches it.
TYPED_TEST(DepositionTest, BinaryLayersCountFromTheFirstThatTouches) {
  constexpr int Dim = TypeParam::value;
  const test::ProcessCase<Dim> process({});
  const LayerDensities layers = process.densities(process.planar_time(), 4, 1.0, true);
  const LaneVector weights =
      Deposition<Dim>(process.model).weights(layers, steps_of_layers(4), process.model.nodes);
  for (std::size_t node = 0; node < weights.unknowns(); ++node)
    for (int j = 0; j < 4; ++j) {
      EXPECT_TRUE(weights(node, j) == 0.0 || weights(node, j) == 1.0);
      if (j > 0) {
        EXPECT_GE(weights(node, j), weights(node, j - 1));
      }
    }
}

TYPED_TEST(DepositionTest, TheDisplacementIsTheSumOfWhatCounts) {
  constexpr int Dim = TypeParam::value;
  test::CaseSettings<Dim> settings;
  settings.process.deposition = DepositionModel::nominal;
  test::ProcessCase<Dim> process(settings);
  const LayerDensities layers = process.densities(process.wavy_time(), 10, 25.0);
  std::vector<double> expected;
  const auto increments = process.dense_increments(layers);
  for (int j = 0; j < 10; ++j) {
    expected.resize(increments[j].size(), 0.0);
    const auto weights = expected_weights(process, layers, j);
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += weights[i / Dim] * increments[j][i];
  }
  const ProcessResult& result = process.simulate(layers);
  EXPECT_LT(test::relative_difference(process.whole(result.displacement), expected), 1e-7);
  std::vector<double> counted(result.displacement.size(), 0.0);
  for (int j = 0; j < 10; ++j) {
    const auto increment = process.simulation.layer_increment(j, true);
    for (std::size_t i = 0; i < counted.size(); ++i) counted[i] += increment[i];
  }
  EXPECT_LT(test::relative_difference(counted, result.displacement), 1e-14);
}

/// A column that shrinks along its axis only, one element per layer. Each layer shrinks by strain *
/// thickness: its top moves by that, and under `follow` also by what all layers below have shrunk before.
TYPED_TEST(DepositionTest, FreeColumn) {
  constexpr int Dim = TypeParam::value;
  constexpr int up = Dim - 1;
  constexpr double strain = -0.02;
  for (const DepositionModel model : {DepositionModel::nominal, DepositionModel::follow}) {
    test::CaseSettings<Dim> settings;
    settings.shape = test::block<Dim>();
    settings.material = {1.0, 0.0, std::vector<double>(voigt_size<Dim>, 0.0)};
    settings.material.inherent_strain[up] = strain;
    settings.process.deposition = model;
    test::ProcessCase<Dim> process(settings);
    const int layers = process.grid().domain().elements[up];
    const auto& displacement =
        process.simulate(process.densities(process.planar_time(), layers, 1.0, true)).displacement;
    process.grid().owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t number) {
      const int below = node[up], counted = model == DepositionModel::follow ? below : std::min(below, 1);
      const double expected = strain * counted * process.grid().spacing()[up];
      for (int axis = 0; axis < Dim; ++axis)
        EXPECT_NEAR(displacement[number * Dim + axis], axis == up ? expected : 0.0, 1e-9);
    });
  }
}

}  // namespace
}  // namespace fabseq
