// SPDX-License-Identifier: MIT
/// Configs derived from others: their settings, their effective config and what a run reads from it agree.
#include "fabseq/config/config.h"
#include "sequence/heat_sequence.h"
#include "support/refusal.h"
#include "support/small_configs.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

namespace fabseq {
namespace {

Config read_again(const Config& config) { return make_config(config.effective, ""); }

TEST(DerivedConfigTest, NothingChangedIsTheSameText) {
  for (const char* text : {plane, solid}) {
    const Config config = configure(text);
    Config derived = config;
    complete_derived(derived);
    EXPECT_EQ(to_text(derived.effective), to_text(config.effective));
  }
}

TEST(DerivedConfigTest, ChangedSettingsAreInTheEffectiveConfig) {
  Config config = configure(solid);
  config.elements = {4, 2, 4};
  config.size[0] *= 1.25;
  config.layers.count = 7;
  config.baseline.layers = 9;
  config.material.poisson = 0.21;
  config.process.void_model = VoidModel::quiet;
  config.part.sampling = 3;
  config.part.keep_connected = true;
  config.projection.beta = 30.5;
  config.projection.max = 31.0;
  config.optimizer.later_iterations = 12;
  config.solver.layer_groups = 2;
  config.output.finer_grid = true;
  config.node_sets.begin()->second.within = 0.125;
  auto heat = config.sequence.as<HeatSettings>();
  heat.characteristic_length = 1.75;
  config.sequence.own = heat;
  complete_derived(config);
  const Config again = read_again(config);
  EXPECT_EQ(again.elements, config.elements);
  EXPECT_EQ(again.size, config.size);
  EXPECT_EQ(again.layers.count, 7);
  EXPECT_EQ(again.baseline.layers, 9);
  EXPECT_EQ(again.material.poisson, 0.21);
  EXPECT_EQ(again.process.void_model, VoidModel::quiet);
  EXPECT_EQ(again.part.sampling, 3);
  EXPECT_TRUE(again.part.keep_connected);
  EXPECT_EQ(again.projection.beta, 30.5);
  EXPECT_EQ(again.projection.max, 31.0);
  EXPECT_EQ(again.optimizer.later_iterations, 12);
  EXPECT_EQ(again.solver.layer_groups, 2);
  EXPECT_EQ(again.output.finer_grid, true);
  EXPECT_EQ(again.node_sets.begin()->second.within, 0.125);
  EXPECT_EQ(again.sequence.facts.characteristic_length, 1.75);
  EXPECT_EQ(to_text(again.effective), to_text(config.effective));
}

/// With numbers of all kinds of shapes, in both dimensions.
TEST(DerivedConfigTest, ShapesAreWritten) {
  for (const char* text : {plane, solid}) {
    Config config = configure(text);
    Shape box, sphere, polygon, whole;
    box.kind = Shape::Kind::box;
    sphere.kind = Shape::Kind::sphere;
    sphere.radius = 0.75;
    polygon.kind = Shape::Kind::polygon;
    polygon.polygon = Polygon({{0.0, 0.0}, {2.0, 0.5}, {0.25, 1.5}});
    if (config.dimension() == 3) polygon.axis = 1;
    for (std::size_t axis = 0; axis < config.size.size(); ++axis) {
      box.first.push_back(0.0);
      box.second.push_back(config.size[axis]);
      sphere.first.push_back(0.1 * static_cast<double>(axis));
    }
    whole.kind = Shape::Kind::intersection;
    whole.operands = {box, std::get<Shape>(config.part.source), sphere, polygon};
    config.part.source = whole;
    complete_derived(config);
    EXPECT_EQ(std::get<Shape>(read_again(config).part.source), whole);
  }
}

TEST(DerivedConfigTest, TermsCanBeLeftOut) {
  Config config = configure(solid);
  ASSERT_EQ(config.objective.size(), 2U);
  config.objective.erase(config.objective.begin());
  config.layers.count = 4;
  config.constraints.clear();
  complete_derived(config);
  const Config again = read_again(config);
  ASSERT_EQ(again.objective.size(), 1U);
  EXPECT_EQ(again.objective[0].type, config.objective[0].type);
  EXPECT_TRUE(again.constraints.empty());
  EXPECT_FALSE(config.layers.target);
}

TEST(DerivedConfigTest, RulesHoldForDerivedConfigs) {
  Config config = configure(solid);
  config.projection.beta = 40.0;
  config.projection.max = 30.0;
  EXPECT_EQ(test::refusal([&] { complete_derived(config); }),
            "/projection/max: found 30.0; allowed: \"auto\" or a number >= 40.0 (beta)");
}

}  // namespace
}  // namespace fabseq
