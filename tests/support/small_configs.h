// SPDX-License-Identifier: MIT
/// \file
/// Two small configs, and what becomes of them with some keys set: for the tests of the configuration.
#pragma once

#include "fabseq/config/command_line.h"
#include "fabseq/config/config.h"
#include "support/refusal.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace fabseq {

inline constexpr const char* solid = R"({
  "domain": {"size": [2, 1, 2], "elements": [8, 4, 8]},
  "part": {"box": {"min": [0, 0, 0], "max": [2, 1, 2]}},
  "node_sets": {"top": {"box": {"min": [0, 0, 2], "max": [2, 1, 2]}}, "edge": {"sphere": {"center": [2, 0, 2], "radius": 0.5}}},
  "sequence": {"type": "heat"},
  "layers": {"count": 4},
  "objective": [{"type": "distortion", "nodes": "top"}, {"type": "layer_uniformity"}],
  "constraints": [{"type": "layer_thickness", "target": 0.5}]
})";

inline constexpr const char* plane = R"({
  "domain": {"size": [2, 1], "elements": [8, 4]},
  "part": {"box": {"min": [0, 0], "max": [2, 1]}},
  "node_sets": {"top": {"box": {"min": [0, 1], "max": [2, 1]}}},
  "sequence": {"type": "heat"},
  "layers": {"count": 4},
  "objective": [{"type": "distortion", "nodes": "top"}]
})";

/// Paths and values, as of -set.
using Settings = std::vector<std::pair<std::string, std::string>>;

inline Config configure(const char* text, const Settings& settings = {}) {
  Json document = parse_json(text, "test");
  for (const auto& [path, value] : settings) apply_override(document, path, value);
  return make_config(document, "/base/folder");
}

/// The message of the error, which must be one line.
inline std::string error_of(const char* text, const Settings& settings) {
  std::string message = test::refusal([&] { (void)configure(text, settings); });
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  return message;
}

inline std::string solid_error(const std::string& path, const std::string& value) {
  return error_of(solid, {{path, value}});
}
inline std::string plane_error(const std::string& path, const std::string& value) {
  return error_of(plane, {{path, value}});
}

}  // namespace fabseq
