// SPDX-License-Identifier: MIT
/// A kind of sequence that nothing but this file knows: config, refusals, defaults, design space, sequence
/// and pipeline follow from its registration.
#include "config/config_keys.h"
#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/sequence_kind.h"
#include "fabseq/tasks/starting_design.h"
#include "support/pipeline_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace fabseq {
namespace {

struct ScaledSettings {
  double factor = 0.5;
  double lower = 0.1, upper = 0.9;
  std::string file = "";
};

/// t is a factor times the design, which lives on the part's elements and starts with planar times.
template <int Dim>
class ScaledSequence : public Sequence<Dim> {
 public:
  ScaledSequence(const ScaledSettings& settings, const SequenceContext<Dim>& context)
      : settings_(settings), context_(context), start_(planar_time(context.part, {}).time) {}

  bool has_design() const override { return true; }
  std::size_t variables() const override { return context_.support.size(); }
  DesignSpace space() const override { return {{{settings_.lower, settings_.upper}}}; }
  std::vector<double> initial_design() const override {
    std::vector<double> result;
    for (const double time : start_) result.push_back(space().of(0).from_unit(time));
    return result;
  }
  const PseudoTime<Dim>& update(std::span<const double> design) override {
    time_.time = scaled(design);
    return time_;
  }
  std::vector<std::vector<double>> pull_back(std::span<const TimeDerivatives> rows) override {
    std::vector<std::vector<double>> result;
    for (const TimeDerivatives& row : rows) result.push_back(scaled(row.time));
    return result;
  }

 private:
  std::vector<double> scaled(std::span<const double> values) const {
    std::vector<double> result(values.begin(), values.end());
    for (double& value : result) value *= settings_.factor;
    return result;
  }

  ScaledSettings settings_;
  SequenceContext<Dim> context_;
  std::vector<double> start_;
  PseudoTime<Dim> time_;
};

struct ScaledKind {
  using Settings = ScaledSettings;

  static Section<Settings> keys() {
    return Section<Settings>("sequence")
        .key("factor", &Settings::factor, "Factor of the design", {.range = "(0, 1]"})
        .key("limits", "Bounds of the design", {.type = KeyType::bounds, .default_value = "[0.1, 0.9]"},
             [](Settings& settings, const Json& value, const KeyPlace&) {
               value[0].get_to(settings.lower);
               value[1].get_to(settings.upper);
             })
        .key("of", &Settings::file, "A file", {.type = KeyType::path});
  }
  static void check(const Settings& settings, const Json& keys) {
    if (settings.factor * settings.upper > 1.0)
      refuse("/sequence/limits", shown(keys.at("limits")), "bounds whose product with factor is at most 1");
  }
  static SequenceFacts facts(const Settings& settings) {
    SequenceFacts result{
        .move_limits = {0.3, 0.01}, .gradient_obstacle = "type \"scaled\"", .characteristic_length = 7.0};
    if (!settings.file.empty()) result.files = {{"of", settings.file}};
    return result;
  }
  template <int Dim>
  static SequencePlaces<Dim> places(const Settings& /*settings*/, const Part<Dim>& part) {
    return {DesignSupport<Dim>(part.grid(), false, part.elements())};
  }
  template <int Dim>
  static std::unique_ptr<Sequence<Dim>> make(const Settings& settings, const SequenceContext<Dim>& context) {
    return std::make_unique<ScaledSequence<Dim>>(settings, context);
  }
};

const RegisteredSequence<ScaledKind> scaled({.name = "scaled",
                                             .position = 9,
                                             .has_design = true,
                                             .bounds_key = "limits",
                                             .move_limits = "0.3 for scaled ones",
                                             .last_move_limits = "0.01 for scaled ones"});

const std::string type = R"({"type": "scaled")";

TEST(SequenceKindTest, KindsAreListedByPosition) {
  EXPECT_EQ(of_sequence_kinds(&SequenceTraits::name),
            (std::vector<std::string>{"heat", "direct", "guided", "planar", "file", "scaled"}));
  EXPECT_EQ(sequences_with_gradient(), "heat, guided, planar, or direct with location nodes");
}

TEST(SequenceKindTest, ConfigHasItsKeys) {
  const Config config = configure(plane, {{"sequence", type + R"(, "factor": 0.25, "of": "a.h5"})"}});
  EXPECT_EQ(config.sequence.kind, &scaled);
  EXPECT_EQ(config.sequence.as<ScaledSettings>().factor, 0.25);
  EXPECT_EQ(
      config.effective.at("sequence"),
      Json::parse(R"({"type": "scaled", "factor": 0.25, "limits": [0.1, 0.9], "of": "/base/folder/a.h5"})"));
  EXPECT_EQ(config.sequence.facts.files.at(0).second, "/base/folder/a.h5");
  EXPECT_EQ(make_config(config.effective, "/base").effective, config.effective);
  const auto keys = config_sections();
  const auto ours = std::count_if(keys.begin(), keys.end(), [](const SectionKeys& section) {
    return std::any_of(section.keys.begin(), section.keys.end(),
                       [](const ConfigKey& key) { return key.variant == "scaled"; });
  });
  EXPECT_EQ(ours, 1);
}

TEST(SequenceKindTest, ConfigRefusesWhatDoesNotFit) {
  EXPECT_EQ(plane_error("sequence", type + R"(, "factor": 2})"),
            "/sequence/factor: found 2; allowed: a number in (0, 1]");
  EXPECT_EQ(plane_error("sequence", type + R"(, "limits": [0, 3]})"),
            "/sequence/limits: found [0,3]; allowed: bounds whose product with factor is at most 1");
  EXPECT_EQ(plane_error("sequence", R"({"type": "scald"})"),
            "/sequence/type: found \"scald\"; allowed: heat, direct, guided, planar, file, "
            "scaled");
  EXPECT_EQ(solid_error("sequence", type + "}"),
            "/objective/1/type: found \"layer_uniformity\" with sequence type \"scaled\", for which the "
            "gradient of the pseudo-time is not defined; allowed: this type with sequence type heat, guided, "
            "planar, or direct with location nodes");
}

TEST(SequenceKindTest, OptimizerTakesItsMoveLimits) {
  const Config config = configure(plane, {{"sequence", type + "}"}, {"objective.0.least_squares", "false"}});
  EXPECT_EQ(config.optimizer.move_limit, 0.3);
  EXPECT_EQ(config.optimizer.final_move_limit, 0.01);
  EXPECT_NE(help_text().find("0.02 for times (direct), 0.03 for tilts (guided), 0.3 for scaled ones"),
            std::string::npos);
  EXPECT_NE(
      help_text().find("0.004 on the log scale, 0.003 for tilts, 0.01 for scaled ones, else move_limit"),
      std::string::npos);
  EXPECT_EQ(test::refusal([&] { check_task(config, Task::optimize); }), "no error");
  const Config planar = configure(plane, {{"sequence", R"({"type": "planar"})"}});
  EXPECT_EQ(test::refusal([&] { check_task(planar, Task::optimize); }),
            "/sequence/type: found \"planar\", which has nothing to vary; allowed: heat, direct, guided, "
            "scaled with "
            "-task optimize, all with -task simulate");
}

template <class T>
class SequenceKindPipelineTest : public testing::Test {
 protected:
  static Settings settings() {
    return {{"sequence", type + R"(, "factor": 0.9, "limits": [0.05, 1.05]})"},
            {"objective", R"([{"type": "distortion", "nodes": "tip", "least_squares": false}])"},
            {"constraints", R"([{"type": "deposition_speed", "slack": 0.01}])"}};
  }
};
TYPED_TEST_SUITE(SequenceKindPipelineTest, test::Dimensions);

TYPED_TEST(SequenceKindPipelineTest, ModelAsksTheKind) {
  const test::PipelineCase<TypeParam::value> pipeline(this->settings());
  const auto& setup = pipeline.setup;
  EXPECT_EQ(setup.design_support.places(), setup.part.elements());
  EXPECT_FALSE(setup.design_support.on_nodes());
  EXPECT_FALSE(setup.start);
  EXPECT_EQ(setup.characteristic_length, 7.0);
  EXPECT_FALSE(setup.binary());
}

TYPED_TEST(SequenceKindPipelineTest, PipelineGoesThroughIt) {
  test::PipelineCase<TypeParam::value> pipeline(this->settings());
  Sequence<TypeParam::value>& sequence = pipeline.pipeline.sequence();
  const Design design = starting_design(pipeline.setup, sequence, CommandLine());
  EXPECT_EQ(design.field, sequence.initial_design());
  Design along = design;
  along.field = pipeline.direction(design.field);
  const auto& responses = pipeline.problem.responses();
  const auto state = pipeline.run(design);
  const std::vector<GradientRow> rows = {{{0, 0, 1.0}}, {{1, 1, 1.0}}};
  const std::vector<Design> gradients = pipeline.pipeline.gradients(responses, state, rows);
  const auto expected = test::central_differences(
      [&](double step) {
        const auto values =
            pipeline.pipeline.values(responses, pipeline.run(test::moved(design, step, along)));
        return std::vector<double>{values[0][0], values[1][1]};
      },
      1e-4);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    EXPECT_NE(expected[row], 0.0);
    EXPECT_NEAR(test::dot(gradients[row], along), expected[row], 1e-7 * std::abs(expected[row]));
  }
}

}  // namespace
}  // namespace fabseq
