// SPDX-License-Identifier: MIT
/// Every way in which a config can be wrong, with the line the user sees.
#include "support/small_configs.h"

#include <gtest/gtest.h>

#include <limits>

namespace fabseq {
namespace {

/// The config text without one of its top-level keys.
std::string error_without(const std::string& key) {
  const Json full = parse_json(solid, "test");
  Json document = Json::object();
  for (const auto& [name, value] : full.items()) {
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
  EXPECT_EQ(
      solid_error("projektion", "{}"),
      "/projektion: unknown key; did you mean \"projection\"? allowed here: name, machine, domain, part, "
      "build_plate, substrate, stock, clamps, node_sets, "
      "material, process, thermal, sequence, layers, projection, objective, constraints, baseline, tool, "
      "optimizer, solver, output");
  EXPECT_EQ(solid_error("output.qqqq", "1"),
            "/output/qqqq: unknown key; allowed here: every, checkpoint_every, stages, stress, sensitivity, "
            "finer_grid");
  EXPECT_EQ(error_of(solid, {{"sequence", R"({"type": "planar", "drain": 1})"}}),
            "/sequence/drain: unknown key for type \"planar\"; allowed here: type, direction");
  EXPECT_EQ(solid_error("objective.1.nodes", "top"),
            "/objective/1/nodes: unknown key for type \"layer_uniformity\"; allowed here: type, form, "
            "weight, normalize, scaling");
  EXPECT_EQ(solid_error("part.bx", "1"),
            "/part/bx: unknown key; did you mean \"box\"? allowed here: box, half_space, cylinder, sphere, "
            "polygon, union, "
            "intersection, difference, voxels, mesh, keep, sampling");
  EXPECT_EQ(solid_error("a/b~c\nd", "1").rfind("/a~1b~0c\\nd: unknown key; allowed here: ", 0), 0U);
}

TEST(ConfigErrorsTest, MissingKeys) {
  for (const std::string key : {"domain", "part", "sequence", "layers"}) {
    EXPECT_EQ(error_without(key), "/" + key + ": missing; allowed: an object");
  }
  EXPECT_EQ(error_without("objective"), "/objective: missing; allowed: a list of objects");
  EXPECT_EQ(solid_error("sequence", "{}"),
            "/sequence/type: missing; allowed: heat, direct, guided, planar, file");
  EXPECT_EQ(solid_error("layers", "{}"),
            "/layers/count: missing; allowed: \"auto\" or an integer in [1, 10000]");
  EXPECT_EQ(solid_error("objective.0", "{}"),
            "/objective/0/type: missing; allowed: build_time, distortion, layer_uniformity, "
            "segmentation_alignment");
  EXPECT_EQ(solid_error("constraints.0", R"({"type": "layer_thickness"})"),
            "/constraints/0/target: missing; allowed: a number > 0");
  EXPECT_EQ(solid_error("part", R"({"box": {"min": [0, 0, 0]}})"),
            "/part/box/max: missing; allowed: a list of 3 numbers");
}

TEST(ConfigErrorsTest, WrongTypes) {
  EXPECT_EQ(error_of("[1]", {}), "-config: found [1]; allowed: an object");
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

TEST(ConfigErrorsTest, PlasticFlow) {
  const auto error = [](Settings more) {
    more.insert(more.begin(), {{"process.model", "elastoplastic"}, {"material.yield_stress", "400"}});
    try {
      configure(solid, more);
    } catch (const InputError& found) {
      return std::string(found.what());
    }
    return std::string();
  };
  EXPECT_EQ(error({}), "");
  EXPECT_EQ(error({{"material.yield_stress", "none"}}),
            "/material/yield_stress: found \"none\" with process.model \"elastoplastic\"; allowed: a number");
  EXPECT_EQ(
      error({{"process.deposition", "follow"}}),
      "/process/deposition: found \"follow\" with process.model \"elastoplastic\"; allowed: \"nominal\"");
  EXPECT_EQ(error({{"material.scenarios", "[[1, 1, 1]]"}}),
            "/material/scenarios: found [[1.0,1.0,1.0]] with process.model \"elastoplastic\"; allowed: []: "
            "displacements are not linear in the strain");
  EXPECT_EQ(
      error({{"material.temperatures", "[20, 20]"}}),
      "/material/temperatures: found [20.0,20.0]; allowed: temperatures that rise from one to the next");
  EXPECT_EQ(
      error({{"material.temperatures", "[20, 800]"}, {"material.young_factors", "[1]"}}),
      "/material/young_factors: found 1 numbers; allowed: none, or as many as in /material/temperatures: 2");
}

/// Curves are checked before heat is conducted by them.
TEST(ConfigErrorsTest, CurvesOfHeat) {
  const auto error = [](const Settings& more) {
    Settings settings = {{"material.mass_density", "7.85"},
                         {"process.deposition_rate", "1"},
                         {"thermal", R"({"heat_input": 3e6})"},
                         {"material.conductivity", "40"},
                         {"material.heat_capacity", "600"},
                         {"material.solidification", "1450"},
                         {"material.conductivity_factors", "[1.3, 1, 0.8]"}};
    settings.insert(settings.end(), more.begin(), more.end());
    return error_of(solid, settings);
  };
  const std::string found =
      "/material/conductivity_factors: found 3 numbers; allowed: none, or as many as in "
      "/material/temperatures: ";
  EXPECT_EQ(error({}), found + "0");
  EXPECT_EQ(error({{"material.temperatures", "[20, 400, 800, 900]"}}), found + "4");
  EXPECT_EQ(error({{"material.temperatures", "[20, 400, 800]"}}), "no error");
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
  EXPECT_EQ(solid_error("solver.tolerance", "1"),
            "/solver/tolerance: found 1; allowed: \"auto\" or a number in (0, 1)");
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
            "difference, voxels, mesh");
  EXPECT_EQ(solid_error("node_sets.top.sphere", R"({"center": [0, 0, 0], "radius": 1})"),
            "/node_sets/top: found box, sphere; allowed: exactly one of box, half_space, cylinder, sphere, "
            "polygon, union, intersection, difference, all, near");
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

}  // namespace
}  // namespace fabseq
