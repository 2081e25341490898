// SPDX-License-Identifier: MIT
/// How keys of a config reach their place, and that the effective config is complete.
#include "fabseq/config/config.h"

#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/sequence_kind.h"
#include "sequence/direct_sequence.h"
#include "sequence/heat_sequence.h"
#include "support/small_configs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

namespace fabseq {
namespace {

TEST(ConfigTest, ThicknessesAreThoseOfBeads) {
  const Config config = configure(solid, {{"layers.passes", "3"}});
  EXPECT_EQ(config.layers.target.value().bead, 0.5);
  EXPECT_EQ(config.layers.target.value().value, 1.5);
  EXPECT_EQ(config.layers.height_of(4), 6.0);
  const Config slabs = configure(
      plane, {{"layers", R"({"type": "multi_planar", "subparts": 2, "thickness": 0.5, "passes": 3})"}});
  EXPECT_EQ(slabs.layers.multi_planar.value().slab_thickness(), 1.5);
}

TEST(ConfigTest, ValuesReachTheirPlace) {
  const Config config = configure(
      solid,
      {{"build_plate", "x+"},
       {"sequence.initial", "0.1"},
       {"sequence.mass", "lumped"},
       {"sequence.bounds", "[1e-4, 2]"},
       {"sequence.characteristic_length", "2.5"},
       {"projection.beta", "10"},
       {"projection.max", "510"},
       {"projection.increment", "20"},
       {"layers.count", "auto"},
       {"process.void", "quiet"},
       {"baseline.layers", "20"},
       {"baseline.direction", "[0, 0, 2]"},
       {"solver.reference_method", "gamg"},
       {"output.every", "0"},
       {"objective.1.form", "variance"},
       {"objective.0.mean", "true"},
       {"constraints",
        R"([{"type": "deposition_speed"}, {"type": "layer_thickness", "target": 1, "tolerance": 0.2}])"}});
  EXPECT_EQ(config.plate.axis, 0);
  EXPECT_TRUE(config.plate.upper);
  const auto& heat = config.sequence.as<HeatSettings>();
  EXPECT_EQ(heat.initial, 0.1);
  EXPECT_EQ(heat.mass, MassRule::lumped);
  EXPECT_EQ(heat.min_diffusivity, 1e-4);
  EXPECT_EQ(heat.max_diffusivity, 2.0);
  EXPECT_EQ(heat.characteristic_length, 2.5);
  EXPECT_EQ(config.projection.beta, 10.0);
  EXPECT_EQ(config.projection.max, 510.0);
  EXPECT_EQ(config.projection.increment, 20.0);
  EXPECT_FALSE(config.layers.count);
  EXPECT_EQ(config.process.void_model, VoidModel::quiet);
  EXPECT_EQ(config.baseline.layers, 20);
  EXPECT_EQ(config.baseline.direction, (std::vector<double>{0, 0, 2}));
  EXPECT_EQ(config.solver.method, ReferenceMethod::gamg);
  EXPECT_EQ(config.output.every, 0);
  EXPECT_EQ(config.effective["objective"][1].at("form"), "variance");
  EXPECT_EQ(config.effective["objective"][0].at("mean"), true);
  EXPECT_EQ(config.effective["constraints"][0].at("slack"), 1e-3);
  EXPECT_EQ(config.effective["constraints"][1].at("tolerance"), 0.2);
  EXPECT_EQ(config.layers.target.value().value, 1.0);
}

TEST(ConfigTest, OtherSequences) {
  const Config planar = configure(solid, {{"sequence", R"({"type": "planar", "direction": [1, 0, 1]})"}});
  EXPECT_EQ(planar.sequence.kind->name, "planar");
  EXPECT_EQ(planar.sequence.as<PlanarSettings>().direction, (std::vector<double>{1, 0, 1}));
  EXPECT_TRUE(configure(solid, {{"sequence", R"({"type": "planar"})"}})
                  .sequence.as<PlanarSettings>()
                  .direction.empty());
  const Config file =
      configure(plane, {{"sequence", R"({"type": "file", "file": "../t.h5"})"}, {"objective", "[]"}});
  EXPECT_EQ(file.sequence.kind->name, "file");
  EXPECT_EQ(file.sequence.as<FileSettings>().file, "/base/t.h5");
  EXPECT_EQ(file.sequence.as<FileSettings>().dataset, "time");
  const Config on_elements =
      configure(plane, {{"sequence", R"({"type": "direct"})"}, {"objective.0.least_squares", "false"}});
  EXPECT_EQ(on_elements.sequence.kind->name, "direct");
  EXPECT_EQ(on_elements.sequence.as<DirectSettings>().location, DesignLocation::elements);
  EXPECT_FALSE(on_elements.sequence.as<DirectSettings>().start);
  EXPECT_EQ(on_elements.optimizer.move_limit, 0.02);
  EXPECT_EQ(on_elements.optimizer.final_move_limit, 0.02);
  EXPECT_FALSE(on_elements.has_time_gradient());
  const Config on_nodes = configure(
      plane,
      {{"sequence",
        R"({"type": "direct", "location": "nodes", "start": {"sphere": {"center": [0, 0], "radius": 0.1}}})"},
       {"layers.time_points", "variable"}});
  EXPECT_EQ(on_nodes.sequence.as<DirectSettings>().location, DesignLocation::nodes);
  EXPECT_EQ(on_nodes.sequence.as<DirectSettings>().start->kind, Shape::Kind::sphere);
  EXPECT_TRUE(on_nodes.layers.variable_time_points);
  EXPECT_TRUE(on_nodes.has_time_gradient());
  EXPECT_TRUE(file.objective.empty());
}

TEST(ConfigTest, MultiPlanarLayers) {
  const Settings layerwise = {{"objective", R"([{"type": "distortion", "measure": "layerwise"}])"},
                              {"constraints", "[]"}};
  Settings settings = layerwise;
  settings.emplace_back("layers", R"({"type": "multi_planar", "subparts": 4})");
  const Config plain = configure(plane, settings);
  ASSERT_TRUE(plain.layers.multi_planar);
  EXPECT_FALSE(plain.layers.count);
  EXPECT_EQ(plain.layers.multi_planar->timestamps, (std::vector<double>{0.25, 0.5, 0.75}));
  EXPECT_EQ(plain.layers.multi_planar->thickness, 3.0);
  EXPECT_EQ(plain.layers.multi_planar->time_sharpness, 100.0);
  EXPECT_EQ(plain.layers.multi_planar->slab_sharpness, 10.0);
  EXPECT_EQ(plain.layers.multi_planar->lowest_angles, std::vector<double>(4, 0.0));
  for (const double angle : plain.layers.multi_planar->angles) EXPECT_NEAR(angle, std::acos(0.0), 1e-15);
  EXPECT_FALSE(plain.layers.multi_planar->fixed_time);
  EXPECT_FALSE(configure(plane).layers.multi_planar);
  // Away from the plate, whichever it is: elevation and azimuth in 3D.
  const std::vector<std::pair<std::string, std::vector<double>>> plates = {{"x-", {0.0, 0.0}},
                                                                           {"y-", {0.0, std::acos(0.0)}},
                                                                           {"z+", {-std::acos(0.0), 0.0}},
                                                                           {"x+", {0.0, std::acos(-1.0)}}};
  for (const auto& [plate, angles] : plates) {
    settings = layerwise;
    settings.emplace_back("build_plate", plate);
    settings.emplace_back("layers", R"({"type": "multi_planar", "subparts": 1, "angle_bounds": [-4, 4]})");
    EXPECT_EQ(configure(solid, settings).layers.multi_planar->angles, angles);
  }
  settings = layerwise;
  settings.emplace_back("layers", R"({"type": "multi_planar", "subparts": 2, "angles": [[1, 2], [3, 4]],
      "angle_bounds": [[0, 5], [-1, 6]], "fixed": ["time"], "sharpness": {"slab": 9}, "thickness": 0.2, "timestamps": [0.4]})");
  const MultiPlanarSettings layers = *configure(solid, settings).layers.multi_planar;
  EXPECT_EQ(layers.angles, (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(layers.lowest_angles, (std::vector<double>{0, -1, 0, -1}));
  EXPECT_EQ(layers.highest_angles, (std::vector<double>{5, 6, 5, 6}));
  EXPECT_EQ(layers.slab_sharpness, 9.0);
  EXPECT_TRUE(layers.fixed_time && !layers.fixed_angles);
}

TEST(ConfigTest, StrainScaleActsOnTheRightComponents) {
  const Config config = configure(
      solid, {{"material.inherent_strain", "[1, 2, 3, 4, 5, 6]"}, {"material.strain_scale", "[4, 9, 25]"}});
  EXPECT_EQ(config.material.inherent_strain, (std::vector<double>{4, 18, 75, 4 * 6, 5 * 15, 6 * 10}));
  EXPECT_EQ(config.effective.at("material").at("inherent_strain").dump(), "[1,2,3,4,5,6]");
  EXPECT_EQ(config.effective.at("material").at("strain_scale").dump(), "[4,9,25]");
  const Config flat =
      configure(plane, {{"material.inherent_strain", "[1, 2, 3]"}, {"material.strain_scale", "[4, 0.25]"}});
  EXPECT_EQ(flat.material.inherent_strain, (std::vector<double>{4, 0.5, 3}));
}

TEST(ConfigTest, ShapesOfPartAndNodeSets) {
  const Config config = configure(
      solid,
      {{"part",
        R"({"difference": [{"union": [{"box": {"min": [0,0,0], "max": [2,1,0.6]}}, {"cylinder": {"from": [0,0,0],
               "to": [0,0,1], "radius": 0.5}}]}, {"half_space": {"point": [1,0,0], "normal": [-1,0,1]}},
               {"polygon": {"points": [[0,0],[1,0],[0,1]], "axis": "y"}}], "keep": "connected"})"},
       {"node_sets.edge.samples", "3"}});
  EXPECT_TRUE(config.part.keep_connected);
  const auto& shape = std::get<Shape>(config.part.source);
  ASSERT_EQ(shape.kind, Shape::Kind::difference);
  ASSERT_EQ(shape.operands.size(), 3U);
  EXPECT_EQ(shape.operands[0].operands[1].kind, Shape::Kind::cylinder);
  EXPECT_EQ(shape.operands[0].operands[1].second, (std::vector<double>{0, 0, 1}));
  EXPECT_EQ(shape.operands[0].operands[1].radius, 0.5);
  EXPECT_EQ(shape.operands[1].second, (std::vector<double>{-1, 0, 1}));
  EXPECT_EQ(shape.operands[2].axis, 1);
  EXPECT_EQ(shape.operands[2].polygon.corners()[2][1], 1.0);
  EXPECT_EQ(config.node_sets.at("edge").samples, 3);
  EXPECT_EQ(config.node_sets.at("edge").shape.kind, Shape::Kind::sphere);
  EXPECT_EQ(config.node_sets.at("top").samples, 0);
}

TEST(ConfigTest, VoxelFiles) {
  const Config config = configure(solid, {{"part", R"({"voxels": {"file": "parts/p.h5"}})"}});
  const auto& voxels = std::get<VoxelFile>(config.part.source);
  EXPECT_EQ(voxels.file, "/base/folder/parts/p.h5");
  EXPECT_EQ(voxels.dataset, "density");
  EXPECT_FALSE(voxels.threshold);
  const Config other = configure(
      solid, {{"part", R"({"voxels": {"file": "/abs/p.h5", "dataset": "x/rho", "threshold": 0.5}})"}});
  EXPECT_EQ(std::get<VoxelFile>(other.part.source).file, "/abs/p.h5");
  EXPECT_EQ(std::get<VoxelFile>(other.part.source).dataset, "x/rho");
  EXPECT_EQ(std::get<VoxelFile>(other.part.source).threshold, 0.5);
}

TEST(ConfigTest, EffectiveConfigIsCompleteAndRunsAgainToItself) {
  const std::vector<Settings> variants = {
      {},
      {{"part", R"({"voxels": {"file": "p.h5"}})"}, {"name", "v"}, {"layers.count", "auto"}},
      {{"sequence", R"({"type": "planar"})"}},
      {{"sequence", R"({"type": "direct", "location": "nodes"})"}, {"layers.time_points", "variable"}},
      {{"sequence.type", "direct"},
       {"sequence.location", "nodes"},
       {"sequence.start.sphere", R"({"center": [0, 0, 0], "radius": 1})"}},
      {{"objective.0.measure", "flatness"}, {"objective.0.axis", "z"}, {"sequence.initial", "0.1"}},
      {{"run", R"({"command": "fabseq", "ranks": 4})"}}};
  for (const Settings& settings : variants) {
    const Config config = configure(solid, settings);
    EXPECT_EQ(find_member(config.effective, "run"), nullptr);
    const std::string text = config.effective.dump(1);
    const Config again = make_config(parse_json(text, "effective"), "/somewhere/else");
    EXPECT_EQ(again.effective.dump(1), text);
    EXPECT_EQ(again.name, config.name);
    EXPECT_EQ(again.material.inherent_strain, config.material.inherent_strain);
    EXPECT_EQ(again.optimizer.final_move_limit, config.optimizer.final_move_limit);
  }
  const Json effective = configure(plane).effective;
  EXPECT_EQ(effective.at("build_plate").dump(), "\"y-\"");
  EXPECT_EQ(effective.at("domain").dump(), R"({"size":[2,1],"elements":[8,4],"thickness":1.0})");
  EXPECT_EQ(effective.at("optimizer").at("asymptotes").dump(),
            R"({"initial":0.5,"increase":1.2,"decrease":0.7,"floor":0.1})");
  EXPECT_EQ(effective.at("objective")[0].at("scaling").get<std::string>(), "current");
  EXPECT_EQ(find_member(configure(solid).effective.at("domain"), "thickness"), nullptr);
}

TEST(ConfigTest, ReferenceCases) {
  for (const std::string name : {"table_2d", "arch_quiet_3d", "steps_planar_3d", "hook_nodes_2d"}) {
    std::ifstream file(std::string(FABSEQ_TEST_DATA) + "/reference/cases/" + name + ".json");
    ASSERT_TRUE(file) << name;
    std::ostringstream text;
    text << file.rdbuf();
    const Config config = make_config(parse_json(text.str(), name), "/base");
    EXPECT_EQ(config.name, name);
    const Config again = make_config(config.effective, "/base");
    EXPECT_EQ(again.effective.dump(), config.effective.dump());
    if (name == "table_2d") {
      EXPECT_EQ(config.thickness, 0.6);
      EXPECT_EQ(config.node_sets.at("top").samples, 5);
      EXPECT_EQ(config.constraints.size(), 2U);
    }
    if (name == "arch_quiet_3d") {
      EXPECT_EQ(config.process.void_model, VoidModel::quiet);
      EXPECT_EQ(config.sequence.as<HeatSettings>().filter_radius, 0.3);
      EXPECT_EQ(config.effective["objective"][1].at("axis"), "z");
    }
    if (name == "steps_planar_3d") {
      EXPECT_EQ(config.sequence.as<PlanarSettings>().direction, (std::vector<double>{0, 0, 1}));
      EXPECT_TRUE(config.projection.binary);
      EXPECT_EQ(config.material.young, 70000.0);
    }
  }
}

TEST(ConfigTest, OverridesFollowPaths) {
  Json document = parse_json(solid, "test");
  apply_override(document, "objective.1.weight", "0.1");
  apply_override(document, "objective.distortion.weight", "2");
  apply_override(document, "part.keep", "connected");
  apply_override(document, "projection.binary", "true");
  apply_override(document, "optimizer.asymptotes.floor", "0.2");
  apply_override(document, "node_sets.top.box.max.1", "0.5");
  const Config config = make_config(document, "/base");
  EXPECT_EQ(config.objective[1].weight, 0.1);
  EXPECT_EQ(config.objective[0].weight, 2.0);
  EXPECT_TRUE(config.part.keep_connected);
  EXPECT_TRUE(config.projection.binary);
  EXPECT_EQ(config.optimizer.mma.asymptote_floor, 0.2);
  EXPECT_EQ(config.node_sets.at("top").shape.second[1], 0.5);
}

}  // namespace
}  // namespace fabseq
