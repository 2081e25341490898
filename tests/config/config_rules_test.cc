// SPDX-License-Identifier: MIT
/// Relations between keys that are refused.
#include "support/small_configs.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace fabseq {
namespace {

TEST(ConfigRulesTest, Names) {
  EXPECT_EQ(solid_error("name", "\"a/b\""),
            "/name: found \"a/b\"; allowed: a text without '/' and control characters, other than . and ..");
  EXPECT_EQ(solid_error("name", "\"..\"").rfind("/name: found \"..\"; ", 0), 0U);
  EXPECT_EQ(solid_error("name", "\"\""), "/name: found \"\"; allowed: a text");
  const std::string set = R"({"box": {"min": [0, 0, 0], "max": [1, 1, 1]}})";
  for (const std::string name : {"", "a.b", "a/b", "a\\nb"}) {
    const std::string message = solid_error("node_sets", "{\"" + name + "\": " + set + "}");
    EXPECT_EQ(message.rfind("/node_sets/", 0), 0U) << message;
    EXPECT_NE(message.find("; allowed: names without '.', '/' and control characters, not empty"),
              std::string::npos)
        << message;
  }
  EXPECT_EQ(solid_error("node_sets.top.samples", "1"),
            "/node_sets/top/samples: found 1; allowed: 0 (all nodes) or an integer >= 2");
}

TEST(ConfigRulesTest, NodeSetsOfTerms) {
  EXPECT_EQ(solid_error("objective.0.nodes", "tpo"),
            "/objective/0/nodes: found unknown node set \"tpo\", did you mean \"top\"?; allowed: edge, top");
  EXPECT_EQ(solid_error("objective.0.nodes", "bottom"),
            "/objective/0/nodes: found unknown node set \"bottom\"; allowed: edge, top");
  EXPECT_EQ(solid_error("objective.0", R"({"type": "distortion"})"),
            "/objective/0/nodes: missing; allowed: name of a node set (edge, top)");
  EXPECT_EQ(error_of(solid, {{"node_sets", "{}"}}),
            "/objective/0/nodes: found unknown node set \"top\"; allowed: none, as node_sets is empty");
  EXPECT_EQ(solid_error("objective.0.measure", "layerwise"),
            "/objective/0/nodes: found \"top\"; allowed: no node set with measure layerwise, which takes all "
            "nodes");
  EXPECT_EQ(solid_error("objective.0", R"({"type": "distortion", "measure": "layerwise"})"), "no error");
}

TEST(ConfigRulesTest, KeysThatNeedEachOther) {
  EXPECT_EQ(error_of(solid, {{"layers.count", "auto"}, {"constraints", "[]"}}),
            "/layers/count: found \"auto\" without layers.target and a layer_thickness constraint; allowed: "
            "an integer in "
            "[1, 10000], or \"auto\" with layers.target or a constraint of type layer_thickness");
  const std::string file = R"({"type": "file", "file": "t.h5"})";
  const std::string reason =
      " with sequence type \"file\", for which the gradient of the pseudo-time is not defined; allowed: this "
      "type with "
      "sequence type heat, guided, planar, or direct with location nodes";
  EXPECT_EQ(error_of(solid, {{"sequence", file}}), "/objective/1/type: found \"layer_uniformity\"" + reason);
  EXPECT_EQ(error_of(solid, {{"sequence", file}, {"objective", "[]"}}),
            "/constraints/0/type: found \"layer_thickness\"" + reason);
  const std::string of_elements =
      " with sequence type \"direct\" and location \"elements\"" + reason.substr(reason.find(", for which"));
  EXPECT_EQ(error_of(solid, {{"sequence", R"({"type": "direct"})"}}),
            "/objective/1/type: found \"layer_uniformity\"" + of_elements);
  EXPECT_EQ(error_of(solid, {{"sequence", R"({"type": "direct"})"}, {"objective", "[]"}}),
            "/constraints/0/type: found \"layer_thickness\"" + of_elements);
  EXPECT_EQ(error_of(solid, {{"sequence", R"({"type": "direct", "location": "nodes"})"}}), "no error");
  const std::string reach = R"([{"type": "tool_clearance"}])", torch = "[[4, 1], [200, 30]]";
  const Settings turning = {
      {"sequence", file}, {"objective", "[]"}, {"constraints", reach}, {"tool.profile", torch}};
  EXPECT_EQ(error_of(solid, turning), "/constraints/0/type: found \"tool_clearance\"" + reason);
  Settings upright = turning;
  upright.emplace_back("tool.axis", "[0, 0, 1]");
  EXPECT_EQ(error_of(solid, upright).find("tool_clearance"), std::string::npos) << error_of(solid, upright);
  EXPECT_EQ(error_of(solid, {{"sequence", R"({"type": "planar", "direction": [0, 0, 0]})"}}),
            "/sequence/direction: found [0,0,0]; allowed: \"auto\" or a vector other than 0");
  EXPECT_EQ(solid_error("baseline.direction", "[0, 0, 0]"),
            "/baseline/direction: found [0,0,0]; allowed: \"auto\", \"best\" or a vector other than 0");
}

TEST(ConfigRulesTest, PassesOfALayer) {
  const std::string heat =
      R"({"conductivity": 0.04, "heat_capacity": 600, "vanishing": 1450, "heat_input": 3e6)";
  const auto configured = [&](const std::string& passes, const std::string& of_heat) {
    return Settings{{"layers.passes", passes},
                    {"thermal", heat + of_heat + "}"},
                    {"material.mass_density", "7.85e-6"},
                    {"process.deposition_rate", "2.5"}};
  };
  const auto passes = [&](const Settings& settings) {
    const Config config = configure(solid, settings);
    return std::pair(config.layers.passes, config.thermal->passes);
  };
  EXPECT_EQ(passes(configured("1", "")), std::pair(1, 1));
  EXPECT_EQ(passes(configured("3", "")), std::pair(3, 3));
  EXPECT_EQ(passes(configured("3", R"(, "passes": 3)")), std::pair(3, 3));
  EXPECT_EQ(passes(configured("1", R"(, "passes": 3)")), std::pair(1, 3));
  EXPECT_EQ(error_of(solid, configured("3", R"(, "passes": 2)")),
            "/thermal/passes: found 2 with layers.passes 3; allowed: \"layers\" or the same number");
  EXPECT_EQ(solid_error("layers.passes", "0"), "/layers/passes: found 0; allowed: an integer in [1, 1000]");
  EXPECT_EQ(solid_error("layers.passes", "1.5"),
            "/layers/passes: found 1.5; allowed: an integer in [1, 1000]");
}

TEST(ConfigRulesTest, DirectSequences) {
  const auto error = [](const std::string& keys) {
    return error_of(plane, {{"sequence", R"({"type": "direct", )" + keys + "}"}});
  };
  EXPECT_EQ(error(R"("location": "node")"), "/sequence/location: found \"node\"; allowed: elements, nodes");
  EXPECT_EQ(error(R"("start": "plte")"),
            "/sequence/start: found \"plte\"; allowed: \"plate\" or an object with one shape");
  EXPECT_EQ(error(R"("start": 3)").rfind("/sequence/start: found 3; allowed: ", 0), 0U);
  EXPECT_EQ(error(R"("start": {"box": {"min": [1, 0], "max": [0, 0]}})"),
            "/sequence/start/box/max/0: found 0; allowed: a number >= 1 (that entry of min)");
  EXPECT_EQ(error(R"("start": {"box": {"min": [0, 0], "max": [0, 0]}})"), "no error");
  EXPECT_EQ(error(R"("bounds": [0, 1])").rfind("/sequence/bounds: unknown key for type \"direct\"", 0), 0U);
}

TEST(ConfigRulesTest, LeastVolumesOfAllLayersMustFit) {
  EXPECT_EQ(solid_error("constraints.0", R"({"type": "minimum_layer_volume", "fraction": 0.3})"),
            "/constraints/0/fraction: found 0.3 for each of 4 layers; allowed: at most 1 / layers.count");
  EXPECT_EQ(solid_error("constraints.0", R"({"type": "minimum_layer_volume", "fraction": 0.25})"),
            "no error");
}

TEST(ConfigRulesTest, StrainsThatTurn) {
  const std::string allowed =
      "; allowed: a list of 6 numbers (xx, yy, zz, xy, yz, zx) or {\"tangential\": number, \"normal\": "
      "number}";
  EXPECT_EQ(solid_error("material.inherent_strain", R"({"tangential": -0.01, "normal": 0})"), "no error");
  EXPECT_EQ(solid_error("material.inherent_strain", R"({"tangential": -0.01})"),
            "/material/inherent_strain: found {\"tangential\":-0.01}" + allowed);
  EXPECT_EQ(solid_error("material.inherent_strain", R"({"tangential": -0.01, "normals": 0})"),
            "/material/inherent_strain: found {\"tangential\":-0.01,\"normals\":0}" + allowed);
  EXPECT_EQ(solid_error("material.inherent_strain", R"({"tangential": "all", "normal": 0})"),
            "/material/inherent_strain/tangential: found \"all\"; allowed: a number");
  EXPECT_EQ(error_of(solid, {{"sequence", R"({"type": "file", "file": "a.h5"})"},
                             {"objective", "[]"},
                             {"constraints", "[]"},
                             {"material.inherent_strain", R"({"tangential": -0.01, "normal": 0})"}}),
            "/material/inherent_strain: found {\"tangential\":-0.01,\"normal\":0} with sequence type "
            "\"file\", for which "
            "the gradient of the pseudo-time is not defined; allowed: a list of numbers, or sequence type "
            "heat, guided, planar, or direct with location nodes");
  const Settings turning = {{"material.inherent_strain", R"({"tangential": -0.01, "normal": 0})"},
                            {"sequence", R"({"type": "direct"})"}};
  EXPECT_NE(error_of(plane, turning).find("/material/inherent_strain: "), std::string::npos);
  EXPECT_NE(error_of(plane, turning).find("\"direct\" and location \"elements\""), std::string::npos);
}

TEST(ConfigRulesTest, SubstrateClampsAndRelease) {
  EXPECT_EQ(solid_error("substrate", R"({"box": {"min": [0, 0, 0], "max": [2, 1, 0.5]}})"), "no error");
  for (const std::string key : {"substrate", "clamps"}) {
    EXPECT_EQ(solid_error(key, R"({"box": {"min": [0, 0, 0]}})"),
              "/" + key + "/box/max: missing; allowed: a list of 3 numbers");
    EXPECT_EQ(solid_error(key, "{}").rfind("/" + key + ": found no shape; allowed: exactly one of box, ", 0),
              0U);
    EXPECT_EQ(solid_error(key, R"({"box": {"min": [1, 0, 0], "max": [0, 1, 1]}})"),
              "/" + key + "/box/max/0: found 0; allowed: a number >= 1 (that entry of min)");
    EXPECT_EQ(
        solid_error(key, R"({"voxels": {"file": "a.h5"}})").rfind("/" + key + "/voxels: unknown key", 0), 0U);
  }
  EXPECT_EQ(solid_error("objective.0.after_release", "true"), "no error");
  EXPECT_EQ(
      solid_error("objective.0", R"({"type": "distortion", "measure": "layerwise", "after_release": true})"),
      "/objective/0/after_release: found true with measure layerwise; allowed: true only with measures "
      "displacement, flatness, shape and angle");
}

TEST(ConfigRulesTest, LeastSquaresNeedAMeasureWithFunctionals) {
  for (const char* value : {"true", "false", "auto"})
    EXPECT_EQ(solid_error("objective.0.least_squares", value), "no error") << value;
  EXPECT_EQ(solid_error("objective.0.least_squares", "1"),
            "/objective/0/least_squares: found 1; allowed: \"auto\" or true or false");
  const auto layerwise = [](const std::string& squares) {
    return solid_error("objective.0",
                       R"({"type": "distortion", "measure": "layerwise", "least_squares": )" + squares + "}");
  };
  EXPECT_EQ(layerwise("false"), "no error");
  EXPECT_EQ(layerwise(R"("auto")"), "no error");
  EXPECT_EQ(layerwise("true"),
            "/objective/0/least_squares: found true with measure layerwise; allowed: true only with measures "
            "displacement, flatness and shape; \"auto\" or false");
  const std::string shape = R"("type": "distortion", "measure": "shape", "nodes": "top")";
  EXPECT_EQ(solid_error("objective.0", "{" + shape + R"(, "least_squares": true})"), "no error");
}

TEST(ConfigRulesTest, AnglesAreBetweenTwoNodeSets) {
  const auto error = [](const std::string& keys) {
    return solid_error("objective.0", R"({"type": "distortion", "nodes": "top", )" + keys + "}");
  };
  EXPECT_EQ(error(R"("measure": "angle", "to": "edge", "after_release": true)"), "no error");
  EXPECT_EQ(error(R"("measure": "angle")"),
            "/objective/0/to: missing; allowed: name of a node set (edge, top)");
  EXPECT_EQ(error(R"("measure": "angle", "to": "egde")"),
            "/objective/0/to: found unknown node set \"egde\", did you mean \"edge\"?; allowed: edge, top");
  EXPECT_EQ(error(R"("measure": "angle", "to": "top")"),
            "/objective/0/to: found \"top\", the node set of nodes; allowed: name of another node set");
  EXPECT_EQ(error(R"("to": "edge")"),
            "/objective/0/to: found \"edge\" with measure displacement; allowed: only with measure angle");
  EXPECT_EQ(error(R"("measure": "angle", "to": "edge", "least_squares": true)"),
            "/objective/0/least_squares: found true with measure angle; allowed: true only with measures "
            "displacement, flatness and shape; \"auto\" or false");
}

TEST(ConfigRulesTest, NormsAreOfDisplacement) {
  const auto error = [](const std::string& keys) {
    return solid_error("objective.0", R"({"type": "distortion", "nodes": "top", )" + keys + "}");
  };
  EXPECT_EQ(error(R"("norm": 2)"), "no error");
  EXPECT_EQ(error(R"("norm": 8.5, "least_squares": "auto")"), "no error");
  EXPECT_EQ(error(R"("norm": 1.9)"), "/objective/0/norm: found 1.9; allowed: a number >= 2");
  EXPECT_EQ(error(R"("norm": 8, "mean": true)"),
            "/objective/0/mean: found true with a norm; allowed: false with a norm, which is a mean");
  EXPECT_EQ(error(R"("norm": 8, "least_squares": true)"),
            "/objective/0/least_squares: found true with a norm; allowed: \"auto\" or false with a norm");
  EXPECT_EQ(error(R"("norm": 8.0, "measure": "shape")"),
            "/objective/0/norm: found 8.0 with measure shape; allowed: only with measure displacement");
}

TEST(ConfigRulesTest, LimitsOfDistortion) {
  const auto error = [](const std::string& keys) {
    return solid_error("constraints.0", R"({"type": "distortion", )" + keys + "}");
  };
  EXPECT_EQ(error(R"("nodes": "top", "limit": 0.3, "norm": 8, "after_release": true)"), "no error");
  EXPECT_EQ(error(R"("measure": "layerwise", "limit": 0.3)"), "no error");
  EXPECT_EQ(error(R"("nodes": "top")"), "/constraints/0/limit: missing; allowed: a number > 0");
  EXPECT_EQ(error(R"("nodes": "top", "limit": 0)"), "/constraints/0/limit: found 0; allowed: a number > 0");
  EXPECT_EQ(error(R"("limit": 1)"), "/constraints/0/nodes: missing; allowed: name of a node set (edge, top)");
  EXPECT_EQ(error(R"("nodes": "top", "limit": 1, "least_squares": true)")
                .rfind("/constraints/0/least_squares: unknown key for type \"distortion\"", 0),
            0U);
}

/// `keys` are those of the layers beside their type.
std::string multi_planar_error(const char* text, const std::string& keys, const Settings& more = {}) {
  Settings settings = {{"layers", "{\"type\": \"multi_planar\"" + keys + "}"},
                       {"objective", R"([{"type": "distortion", "measure": "layerwise"}])"},
                       {"constraints", "[]"}};
  settings.insert(settings.end(), more.begin(), more.end());
  return error_of(text, settings);
}

TEST(ConfigRulesTest, MultiPlanarLayers) {
  const std::string two = R"(, "subparts": 2)";
  EXPECT_EQ(multi_planar_error(solid, two), "no error");
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "angles": [[0.3], [1.2]], "fixed": ["time"])"), "no error");
  EXPECT_EQ(multi_planar_error(plane, ""), "/layers/subparts: missing; allowed: an integer in [1, 100]");
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "count": 3)")
                .rfind("/layers/count: unknown key for type \"multi_planar\"", 0),
            0U);
  for (const char* timestamps : {"[0.2, 0.4]", "[]"})
    EXPECT_EQ(multi_planar_error(plane, two + R"(, "timestamps": )" + timestamps),
              std::string("/layers/timestamps: found ") + parse_json(timestamps, "test").dump() +
                  "; allowed: \"auto\" or 1 ascending numbers in (0, 1), one less than subparts");
  EXPECT_EQ(multi_planar_error(plane, R"(, "subparts": 3, "timestamps": [0.4, 0.4])")
                .rfind("/layers/timestamps", 0),
            0U);
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "timestamps": [1.0])"),
            "/layers/timestamps/0: found 1.0; allowed: \"auto\" or a list of numbers in (0, 1)");
  EXPECT_EQ(multi_planar_error(solid, two + R"(, "origin": [-1, 0, 2.5])"), "no error");
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "origin": [0, 0, 0])"),
            "/layers/origin: found [0,0,0]; allowed: \"auto\" or 2 numbers");
  EXPECT_EQ(multi_planar_error(solid, two + R"(, "origin": [])"),
            "/layers/origin: found []; allowed: \"auto\" or 3 numbers");
  EXPECT_EQ(multi_planar_error(solid, two + R"(, "angles": [[0.3], [1.2]])"),
            "/layers/angles/0: found [0.3]; allowed: a list of 2 numbers");
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "angles": [[0.3]])"),
            "/layers/angles: found [[0.3]] for 2 sub-parts; allowed: a list of angles for each of them");
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "angles": [[0.3], [-0.1]])"),
            "/layers/angles/1/0: found -0.1; allowed: a number within its bounds, 0.0 to 1.5708");
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "angles": [[0.3], [-0.1]], "angle_bounds": [-1, 1])"),
            "no error");
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "angle_bounds": [[0, 2], [0, 2], [0, 2]])"),
            "/layers/angle_bounds: found 3 pairs; allowed: one pair, 1 or 2");
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "angle_bounds": [1, 0])").rfind("/layers/angle_bounds", 0),
            0U);
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "fixed": ["angles", "time"])"),
            "/layers/fixed: found [\"angles\",\"time\"]; allowed: [], [\"angles\"] or [\"time\"]");
  EXPECT_EQ(multi_planar_error(plane, two + R"(, "fixed": ["angle"])"),
            "/layers/fixed/0: found \"angle\"; allowed: angles, time");
  EXPECT_EQ(
      multi_planar_error(plane, two, {{"projection.beta", "20"}}),
      "/projection/beta: found 20; allowed: \"auto\" with layers of type multi_planar, whose sharpness is "
      "layers.sharpness");
}

TEST(ConfigRulesTest, TermsOfTheOtherKindOfLayers) {
  const std::string two = R"(, "subparts": 2)";
  EXPECT_EQ(solid_error("constraints.0", R"({"type": "subpart_volume"})"),
            "/constraints/0/type: found \"subpart_volume\" with layers of type \"curved\"; allowed: this "
            "type with layers "
            "of type multi_planar");
  EXPECT_EQ(solid_error("objective.0", R"({"type": "segmentation_alignment"})").rfind("/objective/0/type", 0),
            0U);
  for (const std::string name : {"layer_thickness", "deposition_speed", "minimum_layer_volume"}) {
    const std::string target = name == "layer_thickness" ? R"(, "target": 1)" : "";
    const std::string term = "[{\"type\": \"" + name + "\"" + target + "}]";
    EXPECT_EQ(multi_planar_error(solid, two, {{"constraints", term}}),
              "/constraints/0/type: found \"" + name +
                  "\" with layers of type \"multi_planar\"; allowed: this type with "
                  "layers of type curved");
  }
  EXPECT_EQ(multi_planar_error(solid, two, {{"objective", R"([{"type": "layer_uniformity"}])"}})
                .rfind("/objective/0/type", 0),
            0U);
  const std::string late = R"(, "subparts": 2, "timestamps": [0.92])";
  EXPECT_EQ(multi_planar_error(solid, late, {{"objective", R"([{"type": "segmentation_alignment"}])"}}),
            "/objective/0/band: found 0.1 after the timestamp 0.92; allowed: a band that ends before 1");
  EXPECT_EQ(
      multi_planar_error(
          solid, two,
          {{"sequence", R"({"type": "direct"})"}, {"objective", R"([{"type": "segmentation_alignment"}])"}})
          .rfind("/objective/0/type: found \"segmentation_alignment\" with sequence type \"direct\"", 0),
      0U);
  // The strain of planar layers turns with them: it needs no gradient.
  EXPECT_EQ(multi_planar_error(solid, two,
                               {{"sequence", R"({"type": "direct"})"},
                                {"material.inherent_strain", R"({"tangential": 1, "normal": 0})"}}),
            "no error");
}

}  // namespace
}  // namespace fabseq
