// SPDX-License-Identifier: MIT
/// Every way in which a config can be wrong, with the line the user sees.
#include <gtest/gtest.h>

#include "support/small_configs.h"
#include <limits>

namespace fabseq {
namespace {

/// The config text without one of its top-level keys.
std::string error_without(const std::string& key) {
  const Json full = parse_json(solid, "test");
  Json document = Json::object();
  for (const auto& [name, value] : full) {
    if (name != key) document[name] = value;
  }
  return error_of(document.dump().c_str(), {});
}

TEST(ConfigErrorsTest, OverridesThatLeadNowhere) {
  EXPECT_EQ(solid_error("objective.2.weight", "1"), "/objective/2: found index 2; allowed: 0 to 1");
  EXPECT_EQ(solid_error("objective.99999999999999999999", "1"),
            "/objective/99999999999999999999: found index 99999999999999999999; allowed: 0 to 1");
  EXPECT_EQ(plane_error("objective.layer_uniformity.weight", "1"),
            "/objective: found no entry of type \"layer_uniformity\"; allowed: an index, or one of the types "
            "distortion");
  EXPECT_EQ(solid_error("sequence.type.kind", "1"),
            "/sequence/type: found \"heat\"; allowed: an object or a list, for -set sequence.type.kind");
  EXPECT_EQ(solid_error("layers..count", "1"),
            "-set layers..count: found an empty key; allowed: keys joined by single dots");
  EXPECT_EQ(solid_error("projection.betta", "1"),
            "/projection/betta: unknown key; did you mean \"beta\"? allowed here: beta, factor, increment, "
            "interval, max, "
            "binary");
  EXPECT_EQ(solid_error("constraints", "[]"), "no error");
  EXPECT_EQ(error_of(solid, {{"constraints", "[]"}, {"constraints.0.target", "1"}}),
            "/constraints/0: found index 0; allowed: none, as the list is empty");
}

TEST(ConfigErrorsTest, UnknownKeys) {
  EXPECT_EQ(solid_error("projektion", "{}"),
            "/projektion: unknown key; did you mean \"projection\"? allowed here: name, domain, part, "
            "build_plate, substrate, clamps, node_sets, "
            "material, process, sequence, layers, projection, objective, constraints, baseline, optimizer, "
            "solver, output");
  EXPECT_EQ(solid_error("output.qqqq", "1"),
            "/output/qqqq: unknown key; allowed here: every, checkpoint_every, stages");
  EXPECT_EQ(error_of(solid, {{"sequence", R"({"type": "planar", "drain": 1})"}}),
            "/sequence/drain: unknown key for type \"planar\"; allowed here: type, direction");
  EXPECT_EQ(solid_error("objective.1.nodes", "top"),
            "/objective/1/nodes: unknown key for type \"layer_uniformity\"; allowed here: type, form, "
            "weight, normalize, scaling");
  EXPECT_EQ(solid_error("part.bx", "1"),
            "/part/bx: unknown key; did you mean \"box\"? allowed here: box, half_space, cylinder, sphere, "
            "polygon, union, "
            "intersection, difference, voxels, keep, sampling");
  EXPECT_EQ(solid_error("a/b~c\nd", "1").rfind("/a~1b~0c\\nd: unknown key; allowed here: ", 0), 0U);
}

TEST(ConfigErrorsTest, MissingKeys) {
  for (const std::string key : {"domain", "part", "sequence", "layers"}) {
    EXPECT_EQ(error_without(key), "/" + key + ": missing; allowed: an object");
  }
  EXPECT_EQ(error_without("objective"), "/objective: missing; allowed: a list of objects");
  EXPECT_EQ(solid_error("sequence", "{}"), "/sequence/type: missing; allowed: heat, direct, planar, file");
  EXPECT_EQ(solid_error("layers", "{}"),
            "/layers/count: missing; allowed: \"auto\" or an integer in [1, 10000]");
  EXPECT_EQ(solid_error("objective.0", "{}"),
            "/objective/0/type: missing; allowed: distortion, layer_uniformity, segmentation_alignment");
  EXPECT_EQ(solid_error("constraints.0", R"({"type": "layer_thickness"})"),
            "/constraints/0/target: missing; allowed: a number > 0");
  EXPECT_EQ(solid_error("part", R"({"box": {"min": [0, 0, 0]}})"),
            "/part/box/max: missing; allowed: a list of 3 numbers");
}

TEST(ConfigErrorsTest, WrongTypes) {
  EXPECT_EQ(error_of("[1]", {}), "/: found [1]; allowed: an object");
  EXPECT_EQ(solid_error("name", "7"), "/name: found 7; allowed: a text");
  EXPECT_EQ(solid_error("material", "3"), "/material: found 3; allowed: an object");
  EXPECT_EQ(solid_error("material.young", "[1,2"), "/material/young: found \"[1,2\"; allowed: a number > 0");
  EXPECT_EQ(solid_error("material.young", "true"), "/material/young: found true; allowed: a number > 0");
  EXPECT_EQ(solid_error("projection.binary", "1"), "/projection/binary: found 1; allowed: true or false");
  EXPECT_EQ(solid_error("optimizer.max_iterations", "2.5"),
            "/optimizer/max_iterations: found 2.5; allowed: an integer >= 1, at most 2147483647");
  EXPECT_EQ(solid_error("optimizer.max_iterations", "3000000000"),
            "/optimizer/max_iterations: found 3000000000; allowed: an integer >= 1, at most 2147483647");
  EXPECT_EQ(configure(solid, {{"optimizer.max_iterations", "1e2"}}).optimizer.max_iterations, 100);
  EXPECT_EQ(solid_error("objective", "{}"), "/objective: found {}; allowed: a list of objects");
  EXPECT_EQ(solid_error("objective.0", "3"), "/objective/0: found 3; allowed: an object");
  EXPECT_EQ(solid_error("node_sets", "[]"), "/node_sets: found []; allowed: an object");
  EXPECT_EQ(solid_error("process.void", "none"), "/process/void: found \"none\"; allowed: absent, quiet");
  EXPECT_EQ(solid_error("process.void", "null"), "/process/void: found null; allowed: absent, quiet");
  const std::string message = solid_error("name", "[\"" + std::string(500, 'x') + "\"]");
  EXPECT_LT(message.size(), 130U) << message;
}

TEST(ConfigErrorsTest, OutOfRange) {
  EXPECT_EQ(solid_error("material.poisson", "0.5"),
            "/material/poisson: found 0.5; allowed: a number in (-1, 0.5)");
  EXPECT_EQ(solid_error("material.poisson", "-1"),
            "/material/poisson: found -1; allowed: a number in (-1, 0.5)");
  EXPECT_EQ(configure(solid, {{"material.poisson", "-0.99"}}).material.poisson, -0.99);
  EXPECT_EQ(solid_error("layers.count", "0"),
            "/layers/count: found 0; allowed: \"auto\" or an integer in [1, 10000]");
  EXPECT_EQ(configure(solid, {{"layers.count", "10000"}}).layers.count, most_layers);
  EXPECT_EQ(solid_error("layers.count", "10001"),
            "/layers/count: found 10001; allowed: \"auto\" or an integer in [1, 10000]");
  EXPECT_EQ(configure(solid, {{"baseline.layers", "10000"}}).baseline.layers, most_layers);
  EXPECT_EQ(solid_error("baseline.layers", "1e9"),
            "/baseline/layers: found 1000000000.0; allowed: \"auto\" or an integer in [1, 10000]");
  EXPECT_EQ(solid_error("projection.beta", "0"),
            "/projection/beta: found 0; allowed: \"auto\" or a number > 0");
  EXPECT_EQ(solid_error("solver.tolerance", "1"), "/solver/tolerance: found 1; allowed: a number in (0, 1)");
  EXPECT_EQ(solid_error("optimizer.move_limit", "1.5"),
            "/optimizer/move_limit: found 1.5; allowed: \"auto\" or a number in (0, 1]");
  EXPECT_EQ(solid_error("sequence.bounds", "[1, 0.5]"),
            "/sequence/bounds: found [1,0.5]; allowed: a list of two ascending numbers > 0");
  EXPECT_EQ(solid_error("sequence.bounds", "[0, 0.5]"),
            "/sequence/bounds/0: found 0; allowed: a list of two ascending numbers > 0");
  EXPECT_EQ(solid_error("sequence.initial", "3"),
            "/sequence/initial: found 3; allowed: \"distance\" or a number within bounds [0.001,1.0]");
  EXPECT_EQ(error_of(solid, {{"projection.beta", "50"}, {"projection.max", "40"}}),
            "/projection/max: found 40; allowed: \"auto\" or a number >= 50.0 (beta)");
  EXPECT_EQ(solid_error("projection.max", "15"),
            "/projection/max: found 15; allowed: \"auto\" or a number >= 16.0 (beta, 4 times the number of "
            "layers)");
  EXPECT_EQ(error_of(solid, {{"optimizer.move_limit", "0.1"}, {"optimizer.final_move_limit", "0.2"}}),
            "/optimizer/final_move_limit: found 0.2; allowed: \"auto\" or a number in (0, 0.1], at most "
            "move_limit");
  EXPECT_EQ(solid_error("output.every", "-1"),
            "/output/every: found -1; allowed: an integer >= 0, at most 2147483647");
}

TEST(ConfigErrorsTest, NotANumber) {
  EXPECT_EQ(solid_error("material.young", "NaN"), "/material/young: found \"NaN\"; allowed: a number > 0");
  EXPECT_EQ(solid_error("material.young", "1e999"),
            "/material/young: found \"1e999\"; allowed: a number > 0");
  Json document = parse_json(solid, "test");
  document["material"] = Json::object({{"young", std::numeric_limits<double>::quiet_NaN()}});
  EXPECT_EQ(error_of(solid, {}), "no error");
  EXPECT_EQ(test::refusal([&] { (void)make_config(document, "/base"); }),
            "/material/young: found nan; allowed: a number > 0");
}

TEST(ConfigErrorsTest, LengthsOfVectors) {
  EXPECT_EQ(solid_error("domain.elements", "[80]"),
            "/domain/elements: found [80]; allowed: a list of 2 or 3 integers >= 1");
  EXPECT_EQ(solid_error("domain.elements", "80"),
            "/domain/elements: found 80; allowed: a list of 2 or 3 integers >= 1");
  EXPECT_EQ(solid_error("domain.elements.1", "0"),
            "/domain/elements/1: found 0; allowed: a list of 3 integers >= 1");
  EXPECT_EQ(solid_error("domain.size", "[2, 1]"),
            "/domain/size: found [2,1]; allowed: a list of 3 numbers > 0 (as many as domain.elements)");
  EXPECT_EQ(solid_error("domain.size.2", "-1"),
            "/domain/size/2: found -1; allowed: a list of 3 numbers > 0 (as many as domain.elements)");
  EXPECT_EQ(plane_error("part.box.min", "[0, 0, 0]"),
            "/part/box/min: found [0,0,0]; allowed: a list of 2 numbers (as many as domain.elements)");
  EXPECT_EQ(plane_error("material.inherent_strain", "[1, 2, 3, 4, 5, 6]"),
            "/material/inherent_strain: found [1,2,3,4,5,6]; allowed: a list of 3 numbers (xx, yy, xy) "
            "or {\"tangential\": number, \"normal\": number}");
  EXPECT_EQ(
      solid_error("material.strain_scale", "[1, 1]"),
      "/material/strain_scale: found [1,1]; allowed: a list of 3 numbers >= 0 (as many as domain.elements)");
  EXPECT_EQ(solid_error("domain.thickness", "2"),
            "/domain/thickness: found 2; allowed: only in 2D, that is with 2 entries in domain.elements");
}

TEST(ConfigErrorsTest, Axes) {
  EXPECT_EQ(solid_error("build_plate", "w-"), "/build_plate: found \"w-\"; allowed: x-, x+, y-, y+, z-, z+");
  EXPECT_EQ(plane_error("build_plate", "z-"), "/build_plate: found \"z-\"; allowed: x-, x+, y-, y+");
  EXPECT_EQ(solid_error("objective.0.measure", "flatness"), "/objective/0/axis: missing; allowed: x, y, z");
  EXPECT_EQ(error_of(plane, {{"objective.0.measure", "flatness"}, {"objective.0.axis", "z"}}),
            "/objective/0/axis: found \"z\"; allowed: x, y");
  EXPECT_EQ(solid_error("objective.0.axis", "z"),
            "/objective/0/axis: found \"z\"; allowed: only with measure flatness");
  EXPECT_EQ(
      error_of(
          solid,
          {{"objective.0.measure", "flatness"}, {"objective.0.axis", "z"}, {"objective.0.mean", "true"}}),
      "/objective/0/mean: found true with measure flatness; allowed: true only with measure displacement");
}

TEST(ConfigErrorsTest, Shapes) {
  EXPECT_EQ(solid_error("part", "{}"),
            "/part: found no shape; allowed: exactly one of box, half_space, cylinder, sphere, polygon, "
            "union, intersection, "
            "difference, voxels");
  EXPECT_EQ(solid_error("node_sets.top.sphere", R"({"center": [0, 0, 0], "radius": 1})"),
            "/node_sets/top: found box, sphere; allowed: exactly one of box, half_space, cylinder, sphere, "
            "polygon, union, "
            "intersection, difference");
  EXPECT_EQ(solid_error("part.box.min.1", "1.5"),
            "/part/box/max/1: found 1; allowed: a number >= 1.5 (that entry of min)");
  EXPECT_EQ(solid_error("part", R"({"union": [{"sphere": {"center": [0, 0, 0], "radius": 0}}]})"),
            "/part/union/0/sphere/radius: found 0; allowed: a number > 0");
  EXPECT_EQ(solid_error("part", R"({"union": []})"),
            "/part/union: found []; allowed: a list of one or more shapes");
  EXPECT_EQ(solid_error("part", R"({"half_space": {"point": [0, 0, 0], "normal": [0, 0, 0]}})"),
            "/part/half_space/normal: found [0,0,0]; allowed: a vector other than 0");
  EXPECT_EQ(solid_error("part", R"({"cylinder": {"from": [0, 0, 1], "to": [0, 0, 1], "radius": 1}})"),
            "/part/cylinder/to: found [0,0,1]; allowed: another point than from");
  EXPECT_EQ(
      plane_error("part", R"({"union": [{"cylinder": {}}]})"),
      "/part/union/0/cylinder: found {}; allowed: only in 3D, that is with 3 entries in domain.elements");
  EXPECT_EQ(solid_error("part", R"({"polygon": {"points": [[0, 0], [1, 0], [0, 1]]}})"),
            "/part/polygon/axis: missing; allowed: x, y, z");
  EXPECT_EQ(
      plane_error("part", R"({"polygon": {"points": [[0, 0], [1, 0], [0, 1]], "axis": "x"}})"),
      "/part/polygon/axis: found \"x\"; allowed: only in 3D, that is with 3 entries in domain.elements");
  EXPECT_EQ(plane_error("part", R"({"polygon": {"points": [[0, 0], [1, 0, 2], [0, 1]]}})"),
            "/part/polygon/points/1: found [1,0,2]; allowed: a list of 2 numbers");
  EXPECT_EQ(plane_error("part", R"({"polygon": {"points": [[0, 0], [1, 0]]}})"),
            "/part/polygon/points: found [[0,0],[1,0]]; allowed: a list of three or more pairs of numbers");
}

TEST(ConfigErrorsTest, Names) {
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

TEST(ConfigErrorsTest, NodeSetsOfTerms) {
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

TEST(ConfigErrorsTest, KeysThatNeedEachOther) {
  EXPECT_EQ(error_of(solid, {{"layers.count", "auto"}, {"constraints", "[]"}}),
            "/layers/count: found \"auto\" without a layer_thickness constraint; allowed: an integer in [1, "
            "10000], "
            "or \"auto\" with a "
            "constraint of type layer_thickness");
  const std::string file = R"({"type": "file", "file": "t.h5"})";
  const std::string reason =
      " with sequence type \"file\", for which the gradient of the pseudo-time is not defined; allowed: this "
      "type with "
      "sequence type heat, planar, or direct with location nodes";
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
  EXPECT_EQ(error_of(solid, {{"sequence", R"({"type": "planar", "direction": [0, 0, 0]})"}}),
            "/sequence/direction: found [0,0,0]; allowed: \"auto\" or a vector other than 0");
  EXPECT_EQ(solid_error("baseline.direction", "[0, 0, 0]"),
            "/baseline/direction: found [0,0,0]; allowed: \"auto\" or a vector other than 0");
}

TEST(ConfigErrorsTest, DirectSequences) {
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

TEST(ConfigErrorsTest, LeastVolumesOfAllLayersMustFit) {
  EXPECT_EQ(solid_error("constraints.0", R"({"type": "minimum_layer_volume", "fraction": 0.3})"),
            "/constraints/0/fraction: found 0.3 for each of 4 layers; allowed: at most 1 / layers.count");
  EXPECT_EQ(solid_error("constraints.0", R"({"type": "minimum_layer_volume", "fraction": 0.25})"),
            "no error");
}

TEST(ConfigErrorsTest, StrainsThatTurn) {
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
            "heat, planar, or direct with location nodes");
  const Settings turning = {{"material.inherent_strain", R"({"tangential": -0.01, "normal": 0})"},
                            {"sequence", R"({"type": "direct"})"}};
  EXPECT_NE(error_of(plane, turning).find("/material/inherent_strain: "), std::string::npos);
  EXPECT_NE(error_of(plane, turning).find("\"direct\" and location \"elements\""), std::string::npos);
}

TEST(ConfigErrorsTest, SubstrateClampsAndRelease) {
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
      "displacement "
      "and flatness");
}

TEST(ConfigErrorsTest, LeastSquaresNeedAMeasureWithFunctionals) {
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
            "displacement and flatness; \"auto\" or false");
}

TEST(ConfigErrorsTest, FeaturesOfLaterVersionsAreRefused) {
  const std::string later = " is not available in this version; allowed: ";
  EXPECT_EQ(solid_error("part", R"({"stl": {"file": "a.stl"}})")
                .rfind("/part/stl: not available in this version; allowed here: box, ", 0),
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

TEST(ConfigErrorsTest, MultiPlanarLayers) {
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

TEST(ConfigErrorsTest, TermsOfTheOtherKindOfLayers) {
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
