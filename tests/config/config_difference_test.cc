// SPDX-License-Identifier: MIT
/// Which changes of a config a checkpoint survives.
#include "fabseq/config/config_difference.h"

#include "fabseq/config/config.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

Json effective(const std::string& text) {
  return make_config(parse_json(text, "config"), "/somewhere").effective;
}

std::string plate(const std::string& more) {
  return R"({"domain": {"size": [2.0, 1.2], "elements": [20, 12]}, "part": {"box": {"min": [0, 0], "max": [2, 1.2]}},
             "sequence": {"type": "heat"}, "layers": {"count": 4},
             "objective": [{"type": "distortion", "measure": "layerwise"}])" +
         more + "}";
}

TEST(ConfigDifference, NoneForTheSameProblem) {
  const Json then = effective(plate(""));
  EXPECT_EQ(config_difference(then, then), "");
  EXPECT_EQ(config_difference(then, parse_json(then.dump(), "again")), "");
  EXPECT_EQ(config_difference(
                then, effective(plate(R"(, "name": "other", "output": {"every": 3, "checkpoint_every": 0},
      "solver": {"tolerance": 1e-9, "path": "reference"}, "optimizer": {"max_iterations": 7, "change_tolerance": 0.1, "objective_tolerance": 0.1, "window": 3})"))),
            "");
}

TEST(ConfigDifference, NamesTheKeyThenAndNow) {
  const Json then = effective(plate(""));
  EXPECT_EQ(config_difference(then, effective(plate(R"(, "optimizer": {"move_limit": 0.03})"))),
            "/optimizer/move_limit was \"auto\", is 0.03 now");
  EXPECT_EQ(config_difference(then, effective(plate(R"(, "constraints": [{"type": "deposition_speed"}])"))),
            "/constraints was [], is [{\"type\":\"deposition_speed\",\"slack\":0.001}] now");
  Json now = then;
  now["domain"]["elements"][1] = 13;
  EXPECT_EQ(config_difference(then, now), "/domain/elements/1 was 12, is 13 now");
  now = then;
  now["part"]["keep"] = "connected";
  EXPECT_EQ(config_difference(then, now), "/part/keep was \"all\", is \"connected\" now");
}

TEST(ConfigDifference, NumbersCountByValue) {
  EXPECT_EQ(config_difference(parse_json(R"({"a": 1, "b": [1.0]})", "x"),
                              parse_json(R"({"b": [1], "a": 1.0})", "y")),
            "");
}

TEST(ConfigDifference, KeysOfOneSideOnly) {
  const Json less = parse_json(R"({"a": 1})", "x"), more = parse_json(R"({"a": 1, "b": 2})", "y");
  EXPECT_EQ(config_difference(less, more), "/b was nothing, is 2 now");
  EXPECT_EQ(config_difference(more, less), "/b was 2, is nothing now");
}

TEST(ConfigDifference, WhereAVoxelFileLiesDoesNotMatter) {
  const Json a = parse_json(R"({"part": {"voxels": {"file": "/a/part.h5", "threshold": 0.5}}})", "x");
  const Json b = parse_json(R"({"part": {"voxels": {"file": "/b/part.h5", "threshold": 0.5}}})", "y");
  const Json c = parse_json(R"({"part": {"voxels": {"file": "/a/part.h5", "threshold": 0.4}}})", "z");
  EXPECT_EQ(config_difference(a, b), "");
  EXPECT_EQ(config_difference(a, c), "/part/voxels/threshold was 0.5, is 0.4 now");
}

}  // namespace
}  // namespace fabseq
