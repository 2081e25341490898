// SPDX-License-Identifier: MIT
/// Machine files: what follows from them for a config, and how they are refused.
#include "config/named_files.h"
#include "fabseq/base/json.h"
#include "support/io_support.h"
#include "support/refusal.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace fabseq {
namespace {

constexpr const char* cell = R"({
  "name": "a cell", "comment": "for tests",
  "axes": {"value": ["x", "y", "z", "table_tilt", "table_turn"], "source": "assumed"},
  "tilt": {"value": 75, "unit": "degrees", "source": "assumed"},
  "torch": {"value": [[4, 1], [15, 9]], "unit": "mm", "source": "assumed"},
  "clearance": {"value": 1, "unit": "mm", "source": "assumed"},
  "bead_height": {"value": 2, "unit": "mm", "source": "assumed"},
  "bead_heights": {"value": [1.2, 3], "unit": "mm", "source": "assumed"},
  "bead_width": {"value": 6, "unit": "mm", "source": "assumed"},
  "bridge": {"value": 10, "unit": "mm", "source": "assumed"},
  "deposition_rate": {"value": 3, "unit": "kg/h", "source": "assumed"},
  "travel_speed": {"value": 9, "unit": "mm/s", "source": "assumed"},
  "interpass_limit": {"value": 150, "unit": "degrees C", "source": "assumed"},
  "plate": {"value": [500, 400], "unit": "mm", "source": "assumed"}
})";

class MachineFileTest : public testing::Test {
 protected:
  void SetUp() override { write(parse_json(cell, "cell")); }

  void write(const Json& machine) const {
    if (test::is_first()) std::ofstream(scratch_.file("cell.json")) << machine.dump();
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  /// The cell with an entry, or a member of one ("tilt/unit"), set or, if null, left out.
  static Json with(const std::string& place, const Json& value) {
    Json machine = parse_json(cell, "cell");
    machine[Json::json_pointer("/" + place)] = value;
    const std::string entry = place.substr(0, place.find('/'));
    if (value.is_null()) {
      if (place == entry) machine.erase(entry);
      if (place != entry) machine[entry].erase(place.substr(entry.size() + 1));
    }
    return machine;
  }
  /// A config with this machine, and what else it says.
  Json merged(const Json& more = Json::object()) const {
    Json document = {{"machine", "cell.json"}, {"domain", {{"unit", "mm"}}}};
    document.merge_patch(more);
    merge_machine_file(PETSC_COMM_WORLD, document, scratch_.path());
    return document;
  }
  /// The message with "FILE" in place of the file's path.
  std::string error_of(const Json& machine, const Json& more = Json::object()) const {
    write(machine);
    std::string message = test::refusal([&] { (void)merged(more); });
    const std::size_t at = message.find(scratch_.path());
    if (at != std::string::npos) message.replace(at, scratch_.path().size() + 10, "FILE");
    return message;
  }

 private:
  test::ScratchDirectory scratch_;
};

TEST_F(MachineFileTest, IsTheToolOfAConfigThatSaysNothing) {
  const Json found = merged();
  EXPECT_FALSE(found.contains("machine"));
  EXPECT_EQ(found["layers"], parse_json(R"({"target": 2.0})", ""));
  EXPECT_EQ(found["tool"],
            parse_json(R"({"thickness": [0.6, 1.5], "name": "a cell", "profile": [[4, 1], [15, 9]],
    "clearance": 1, "max_tilt": 75, "bead_width": 6, "bead_height": 2, "bridge": 10, "travel_speed": 9, "plate": [500, 400]})",
                       ""));
  EXPECT_EQ(found["process"], parse_json(R"({"deposition_rate": 3})", ""));
  EXPECT_FALSE(found.contains("thermal"));
}

TEST_F(MachineFileTest, KeysOfTheConfigStay) {
  const Json more = parse_json(R"({"tool": {"max_tilt": 40, "thickness": [0.1, 9], "plate": []},
    "process": {"deposition_rate": 1}, "layers": {"target": 0.5}, "thermal": {"passes": 2, "interpass_limit": 99}})",
                               "");
  const Json found = merged(more);
  for (const auto& [section, keys] : more.items())
    for (const auto& [key, value] : keys.items())
      EXPECT_EQ(found[section][key], value) << section << " " << key;
  EXPECT_EQ(found["tool"]["bead_width"], 6);
}

TEST_F(MachineFileTest, LengthsAreInTheUnitOfTheConfig) {
  const Json found = merged({{"domain", {{"unit", "m"}}}});
  EXPECT_EQ(found["layers"]["target"], 0.002);
  EXPECT_EQ(found["tool"]["profile"], parse_json("[[0.004, 0.001], [0.015, 0.009]]", ""));
  EXPECT_EQ(found["tool"]["plate"], parse_json("[0.5, 0.4]", ""));
  EXPECT_EQ(found["tool"]["travel_speed"], 0.009);
  EXPECT_EQ(found["tool"]["thickness"], parse_json("[0.6, 1.5]", ""));
}

TEST_F(MachineFileTest, ALayerStandsForSeveralBeads) {
  const Json constraints = parse_json(R"([{"type": "tilt"}, {"type": "layer_thickness", "target": 7}])", "");
  const Json found = merged({{"constraints", constraints}, {"thermal", Json::object()}});
  EXPECT_EQ(found["thermal"], parse_json(R"({"passes": 4, "interpass_limit": 150})", ""));  // of 1.75
  EXPECT_EQ(found["tool"]["thickness"], parse_json("[0.6857142857, 1.714285714]", ""));
  EXPECT_FALSE(found.contains("layers"));
  const Json three = merged({{"constraints", constraints}, {"thermal", {{"passes", 3}}}});
  EXPECT_EQ(three["tool"]["thickness"], parse_json("[0.5142857143, 1.285714286]", ""));
  EXPECT_EQ(merged({{"thermal", {{"passes", 3}}}})["layers"]["target"], 6);
  const Json planes = merged({{"layers", {{"type", "multi_planar"}}}});
  EXPECT_EQ(planes["layers"]["thickness"], 2);
}

TEST_F(MachineFileTest, FillsInNumbersOfConstraints) {
  const Json found = merged({{"constraints", parse_json(R"([{"type": "layer_thickness"},
    {"type": "interpass_temperature"}, {"type": "interpass_temperature", "limit": 7}])",
                                                        "")}});
  EXPECT_EQ(found["constraints"][0]["target"], 2);
  EXPECT_EQ(found["constraints"][1]["limit"], 150);
  EXPECT_EQ(found["constraints"][2]["limit"], 7);
}

TEST_F(MachineFileTest, ATorchThatDoesNotTiltStandsOnThePlate) {
  write(with("axes/value", {"x", "y", "z"}));
  EXPECT_EQ(merged()["tool"]["axis"], Json({0.0, 0.0, 1.0}));
  EXPECT_EQ(merged()["tool"]["max_tilt"], 75);
  EXPECT_EQ(merged({{"build_plate", "x+"}})["tool"]["axis"], Json({-1.0, 0.0, 0.0}));
  EXPECT_EQ(merged({{"domain", {{"elements", {3, 4}}}}})["tool"]["axis"], Json({0.0, 1.0}));
}

TEST_F(MachineFileTest, EntriesThatCannotBeUsed) {
  const std::string entry = "; allowed: an object with value, unit (if it has one) and source";
  EXPECT_EQ(
      error_of(with("tilt/source", nullptr)),
      "FILE: /tilt: found no source; allowed: source: title and address of what says so, or \"assumed\"");
  EXPECT_EQ(
      error_of(with("tilt/source", "")),
      "FILE: /tilt: found no source; allowed: source: title and address of what says so, or \"assumed\"");
  EXPECT_EQ(error_of(with("tilt", 30)), "FILE: /tilt: found 30" + entry);
  EXPECT_EQ(error_of(with("tilt/page", 30)), "FILE: /tilt: found a key \"page\"" + entry);
  EXPECT_EQ(error_of(with("tilt/value", 200)), "FILE: /tilt: found 200; allowed: a number in (0, 180]");
  EXPECT_EQ(error_of(with("tilt/unit", nullptr)), "FILE: /tilt/unit: found none; allowed: \"degrees\"");
  EXPECT_EQ(error_of(with("bead_width/unit", "in")), "FILE: /bead_width/unit: found \"in\"; allowed: \"mm\"");
  EXPECT_EQ(error_of(with("axes/unit", "mm")), "FILE: /axes/unit: found \"mm\"; allowed: none");
  EXPECT_EQ(error_of(with("axes/value", {"x", "y"})),
            "FILE: /axes: found [\"x\",\"y\"]; allowed: x, y, z, and others if there are any");
  EXPECT_EQ(error_of(with("bead_width", nullptr)), "FILE: /bead_width: missing; allowed: a number > 0");
  EXPECT_EQ(error_of(with("bead_heights/value", {2.5, 3})),
            "FILE: /bead_heights: found [2.5,3]; allowed: a range with bead_height, 2.0, in it");
  EXPECT_EQ(error_of(with("plate/value", Json({1.0}))),
            "FILE: /plate: found [1.0]; allowed: two numbers > 0");
  EXPECT_NE(
      error_of(with("bead_with", 1)).find("FILE: /bead_with: unknown key; did you mean \"bead_width\"?"),
      std::string::npos);
}

TEST_F(MachineFileTest, ConfigsThatItDoesNotFit) {
  const Json machine = parse_json(cell, "cell");
  const std::string unit = " with a machine, whose lengths are in mm; allowed: um, mm, cm, m, in or ft";
  EXPECT_EQ(error_of(machine, {{"domain", {{"unit", "ell"}}}}), "/domain/unit: found \"ell\"" + unit);
  EXPECT_EQ(error_of(machine, {{"domain", nullptr}}), "/domain/unit: found none" + unit);
  EXPECT_EQ(error_of(machine, {{"layers", {{"target", 1}}}}),
            "/layers/target: found layers of 1, which are 1 bead of 1 mm; allowed: beads of 1.2 to 3 mm, as "
            "bead_heights of the machine says");
  EXPECT_EQ(
      error_of(machine, {{"layers", {{"target", 9}}}, {"thermal", {{"passes", 2}}}}),
      "/layers/target: found layers of 9, which are 2 beads of 4.5 mm; allowed: beads of 1.2 to 3 mm, as "
      "bead_heights of the machine says");
  EXPECT_EQ(error_of(machine, {{"machine", 3}}), "/machine: found 3; allowed: a file name");
  EXPECT_EQ(error_of(machine, {{"machine", "."}}).rfind("/machine: found ", 0), 0U);
}

}  // namespace
}  // namespace fabseq
