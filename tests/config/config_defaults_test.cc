// SPDX-License-Identifier: MIT
/// What a config has where its keys are left out, and the limits of steps that follow from the others.
#include "fabseq/config/config.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/sequence/sequence_kind.h"
#include "sequence/heat_sequence.h"
#include "support/small_configs.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace fabseq {
namespace {

TEST(ConfigTest, DefaultsIn3d) {
  const Config config = configure(solid);
  EXPECT_EQ(config.name, "fabseq");
  EXPECT_EQ(config.dimension(), 3);
  EXPECT_EQ(config.size, (std::vector<double>{2, 1, 2}));
  EXPECT_EQ(config.elements, (std::vector<int>{8, 4, 8}));
  EXPECT_EQ(config.thickness, 1.0);
  EXPECT_FALSE(config.part.keep_connected);
  EXPECT_EQ(config.plate.axis, 2);
  EXPECT_FALSE(config.plate.upper);
  EXPECT_EQ(config.material.young, 1.0);
  EXPECT_EQ(config.material.poisson, 0.3);
  EXPECT_EQ(config.material.inherent_strain, (std::vector<double>{-0.01, -0.01, -0.01, 0, 0, 0}));
  EXPECT_EQ(config.process.stiffness_penalty, 3.0);
  EXPECT_EQ(config.process.strain_penalty, 3.0);
  EXPECT_EQ(config.process.min_stiffness, 1e-9);
  EXPECT_EQ(config.process.void_model, VoidModel::absent);
  EXPECT_EQ(config.sequence.kind->name, "heat");
  const auto& heat = config.sequence.as<HeatSettings>();
  EXPECT_EQ(heat.scale, VariableScale::log);
  EXPECT_EQ(heat.mass, MassRule::automatic);
  EXPECT_FALSE(heat.initial);
  EXPECT_EQ(heat.drain, 1.0);
  EXPECT_FALSE(heat.characteristic_length);
  EXPECT_EQ(heat.min_diffusivity, 1e-3);
  EXPECT_EQ(heat.max_diffusivity, 1.0);
  EXPECT_EQ(heat.void_diffusivity, 1e-3);
  EXPECT_EQ(heat.filter_radius, 0.0);
  EXPECT_EQ(config.layers.count, 4);
  EXPECT_FALSE(config.projection.beta);
  EXPECT_EQ(config.projection.factor, 1.5);
  EXPECT_EQ(config.projection.increment, 0.0);
  EXPECT_EQ(config.projection.interval, 15);
  EXPECT_FALSE(config.projection.max);
  EXPECT_FALSE(config.projection.binary);
  EXPECT_EQ(config.effective["constraints"][0].at("tolerance"), 0.1);
  EXPECT_EQ(config.layers.target.value().value, 0.5);
  EXPECT_FALSE(config.baseline.layers);
  EXPECT_TRUE(config.baseline.direction.empty());
  EXPECT_EQ(config.solver.tolerance, 1e-6);
  EXPECT_EQ(config.solver.method, ReferenceMethod::automatic);
  EXPECT_EQ(config.output.every, 15);
  EXPECT_EQ(config.output.checkpoint_every, 10);
  EXPECT_FALSE(config.output.stages);
}

TEST(ConfigTest, DefaultsOfTermsAndOptimizer) {
  const Config config = configure(solid);
  ASSERT_EQ(config.objective.size(), 2U);
  const Term &distortion = config.objective[0], &uniformity = config.objective[1];
  EXPECT_EQ(distortion.type->name, "distortion");
  EXPECT_EQ(config.effective["objective"][0].at("measure"), "displacement");
  EXPECT_EQ(config.effective["objective"][0].at("nodes"), "top");
  EXPECT_FALSE(config.effective["objective"][0].contains("axis"));
  EXPECT_EQ(config.effective["objective"][0].at("mean"), false);
  EXPECT_EQ(config.effective["objective"][0].at("least_squares"), "auto");
  EXPECT_EQ(distortion.weight, 1.0);
  EXPECT_EQ(distortion.normalize, 100.0);
  EXPECT_EQ(distortion.scaling, TermScaling::current);
  EXPECT_EQ(config.effective["objective"][1].at("form"), "sum_of_squares");
  EXPECT_EQ(uniformity.scaling, TermScaling::first);
  EXPECT_EQ(uniformity.weight, 0.3);
  const OptimizerSettings& optimizer = config.optimizer;
  EXPECT_EQ(optimizer.max_iterations, 120);
  EXPECT_EQ(optimizer.change_tolerance, 0.0);
  EXPECT_EQ(optimizer.objective_tolerance, 0.0);
  EXPECT_EQ(optimizer.window, 5);
  EXPECT_EQ(optimizer.mma.asymptote_initial, 0.5);
  EXPECT_EQ(optimizer.mma.asymptote_increase, 1.2);
  EXPECT_EQ(optimizer.mma.asymptote_decrease, 0.7);
  EXPECT_EQ(optimizer.mma.asymptote_floor, 0.1);
  EXPECT_EQ(optimizer.constraint_margin, 0.95);
}

TEST(ConfigTest, DefaultsIn2d) {
  const Config config = configure(plane);
  EXPECT_EQ(config.dimension(), 2);
  EXPECT_EQ(config.plate.axis, 1);
  EXPECT_FALSE(config.plate.upper);
  EXPECT_EQ(config.material.inherent_strain, (std::vector<double>{-0.01, -0.01, 0}));
  EXPECT_FALSE(config.layers.target);
  const Domain<2> domain = config.domain<2>();
  EXPECT_EQ(domain.elements[0], 8);
  EXPECT_EQ(domain.size[1], 1.0);
  EXPECT_EQ(domain.thickness, 1.0);
  EXPECT_EQ(configure(plane, {{"domain.thickness", "0.25"}}).domain<2>().thickness, 0.25);
}

std::pair<double, double> move_limits(const Settings& settings) {
  const OptimizerSettings optimizer = configure(solid, settings).optimizer;
  return {optimizer.move_limit, optimizer.final_move_limit};
}

TEST(ConfigTest, AutomaticMoveLimitsFollowTheScale) {
  const auto limits = [](Settings settings) {
    settings.emplace_back("objective.0.least_squares", "false");
    return move_limits(settings);
  };
  EXPECT_EQ(limits({}), std::pair(0.05, 0.004));
  EXPECT_EQ(limits({{"sequence.scale", "linear"}}), std::pair(0.2, 0.2));
  EXPECT_EQ(limits({{"sequence.scale", "linear"}, {"optimizer.move_limit", "0.1"}}), std::pair(0.1, 0.1));
  EXPECT_EQ(limits({{"optimizer.move_limit", "0.002"}}), std::pair(0.002, 0.002));
  EXPECT_EQ(limits({{"optimizer.final_move_limit", "0.01"}}), std::pair(0.05, 0.01));
}

TEST(ConfigTest, LastStepsAreSmallWithLeastSquares) {
  EXPECT_EQ(move_limits({}), std::pair(0.05, 0.001));
  EXPECT_EQ(move_limits({{"sequence.scale", "linear"}}), std::pair(0.2, 0.001));
  EXPECT_EQ(move_limits({{"optimizer.move_limit", "0.0005"}}), std::pair(0.0005, 0.0005));
  EXPECT_EQ(move_limits({{"optimizer.final_move_limit", "0.01"}}), std::pair(0.05, 0.01));
  const std::pair<double, double> plain(0.05, 0.004);
  EXPECT_EQ(move_limits({{"objective.0.scaling", "first"}}), plain);
  EXPECT_EQ(move_limits({{"objective.0.scaling", "first"}, {"objective.0.least_squares", "true"}}),
            std::pair(0.05, 0.001));
  EXPECT_EQ(move_limits({{"objective.0.weight", "0"}}), plain);
  EXPECT_EQ(move_limits({{"objective.0.norm", "8"}}), plain);
  EXPECT_EQ(move_limits({{"objective.0", R"({"type": "distortion", "measure": "layerwise"})"}}), plain);
  EXPECT_EQ(move_limits({{"objective.0", R"({"type": "distortion", "measure": "shape", "nodes": "top"})"}}),
            std::pair(0.05, 0.001));
  const Settings scenarios = {{"material.scenarios", "[[1.1, 1, 1]]"}};
  EXPECT_EQ(move_limits(scenarios), std::pair(0.05, 0.001));
  for (const char* aggregate : {"mean", "spread", "worst"}) {
    Settings aggregated = scenarios;
    aggregated.emplace_back("objective.0.aggregate", aggregate);
    EXPECT_EQ(move_limits(aggregated), plain) << aggregate;
  }
}

}  // namespace
}  // namespace fabseq
