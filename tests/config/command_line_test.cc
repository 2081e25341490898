// SPDX-License-Identifier: MIT
#include "fabseq/config/command_line.h"

#include "config/config_keys.h"
#include "support/refusal.h"

#include <gtest/gtest.h>

#include <set>

namespace fabseq {
namespace {

CommandLine parse(std::vector<const char*> words) {
  words.insert(words.begin(), "fabseq");
  return parse_command_line(static_cast<int>(words.size()), words.data());
}

std::string refusal_of(const std::vector<const char*>& words) {
  return test::refusal([&] { (void)parse(words); });
}

using Overrides = std::vector<std::pair<std::string, std::string>>;

TEST(CommandLineTest, TakesItsOwnOptionsAndLeavesTheRest) {
  const CommandLine line = parse({"-ksp_type", "cg", "-config", "a b.json", "-task", "simulate", "-output",
                                  "out", "-log_view", "-overwrite", "-design", "d.h5", "-ksp_rtol", "-1.5e3",
                                  "-ksp_monitor", "-set", "layers.count=-3", "-info"});
  EXPECT_EQ(line.config_file, "a b.json");
  EXPECT_EQ(line.task, Task::simulate);
  EXPECT_EQ(line.output, "out");
  EXPECT_EQ(line.design_file, "d.h5");
  EXPECT_TRUE(line.overwrite);
  EXPECT_EQ(line.overrides, (Overrides{{"layers.count", "-3"}}));
  const std::vector<std::string> rest = {"fabseq",    "-ksp_type", "cg",           "-log_view",
                                         "-ksp_rtol", "-1.5e3",    "-ksp_monitor", "-info"};
  EXPECT_EQ(line.petsc_arguments, rest);
  EXPECT_EQ(line.text.rfind("fabseq -ksp_type cg -config 'a b.json' -task simulate", 0), 0U) << line.text;
}

TEST(CommandLineTest, Defaults) {
  const CommandLine line = parse({"-config", "c.json"});
  EXPECT_EQ(line.task, Task::optimize);
  EXPECT_FALSE(line.output || line.design_file || line.overwrite || line.help || line.version);
  EXPECT_TRUE(line.overrides.empty());
  EXPECT_EQ(line.petsc_arguments, std::vector<std::string>{"fabseq"});
}

TEST(CommandLineTest, OverridesKeepTheirOrder) {
  const CommandLine line =
      parse({"-config", "c",       "-layers",      "8",           "-set",    "layers.count=9",
             "-alpha",  "0.1",     "-elements",    "80,40,80",    "-layers", "10",
             "-beta",   "auto",    "-solver_path", "reference",   "-name",   "7",
             "-set",    "a=b=c",   "-binary",      "-stages",     "false",   "-move_limit",
             "0.1",     "-target", "0.2",          "-finer_grid", "auto",    "-finer_grid",
             "no"});
  const Overrides expected = {{"layers.count", "8"},
                              {"layers.count", "9"},
                              {"objective.layer_uniformity.weight", "0.1"},
                              {"domain.elements", "[80,40,80]"},
                              {"layers.count", "10"},
                              {"projection.beta", "\"auto\""},
                              {"solver.path", "\"reference\""},
                              {"name", "\"7\""},
                              {"a", "b=c"},
                              {"projection.binary", "true"},
                              {"output.stages", "false"},
                              {"optimizer.move_limit", "0.1"},
                              {"constraints.layer_thickness.target", "0.2"},
                              {"output.finer_grid", "\"auto\""},
                              {"output.finer_grid", "false"}};
  EXPECT_EQ(line.overrides, expected);
}

TEST(CommandLineTest, AGivenSequenceIsForSimulations) {
  EXPECT_EQ(parse({"-config", "c", "-task", "simulate", "-sequence", "t.h5"}).sequence_file, "t.h5");
  EXPECT_FALSE(parse({"-config", "c"}).sequence_file);
  EXPECT_NE(refusal_of({"-config", "c", "-sequence", "t.h5"}).find("-task simulate"), std::string::npos);
  EXPECT_NE(
      refusal_of({"-config", "c", "-task", "simulate", "-sequence", "a", "-design", "b"}).find("-design"),
      std::string::npos);
}

TEST(CommandLineTest, HelpAndVersionNeedNoConfig) {
  EXPECT_TRUE(parse({"-help"}).help);
  EXPECT_TRUE(parse({"--version"}).version);
}

TEST(CommandLineTest, Errors) {
  EXPECT_EQ(refusal_of({}), "-config: missing; allowed: -config FILE.json (-help lists all options)");
  EXPECT_EQ(refusal_of({"-config"}), "-config: missing value; allowed: -config VALUE");
  EXPECT_EQ(refusal_of({"-config", "-task", "check"}), "-config: missing value; allowed: -config VALUE");
  EXPECT_EQ(refusal_of({"-config", "c", "-layers"}), "-layers: missing value; allowed: -layers VALUE");
  EXPECT_EQ(refusal_of({"-config", "c", "-task", "fly"}),
            "-task: found \"fly\"; allowed: optimize, simulate, sensitivity, evaluate, check_gradients, "
            "check, surface, machine");
  EXPECT_EQ(refusal_of({"-config", "c", "-set", "layers"}),
            "-set: found \"layers\"; allowed: -set path.to.key=VALUE");
  EXPECT_EQ(refusal_of({"-config", "c", "-set", "=1"}),
            "-set: found \"=1\"; allowed: -set path.to.key=VALUE");
  EXPECT_EQ(refusal_of({"-config", "c", "-elements", "80", "40", "80"}),
            "\"40\": belongs to no option; allowed: options, each with at most one value");
  EXPECT_EQ(refusal_of({"c.json"}),
            "\"c.json\": belongs to no option; allowed: options, each with at most one value");
}

TEST(CommandLineTest, UnknownOptionsNameTheNearest) {
  const std::string allowed = "allowed: fabseq's options (-help lists them) and PETSc's";
  const std::vector<std::pair<const char*, const char*>> misspelt = {
      {"-max_iteratons", "-max_iterations"},
      {"-alfa", "-alpha"},
      {"--config", "-config"},
      {"-sub_parts", "-subparts"},  // "sub" is a word of PETSc's
      {"-layers=30", "-layers"},
      {"-elastcity_ksp_max_it", "-elasticity_ksp_max_it"},
      {"-objectives_tolerance", "-objective_tolerance"}};
  for (const auto& [word, meant] : misspelt) {
    EXPECT_EQ(refusal_of({"-config", "c", word, "10"}),
              std::string(word) + ": unknown option; did you mean \"" + meant + "\"? " + allowed);
  }
  for (const char* stranger : {"-quite_something_else", "-logview", "-mesh_files"})
    EXPECT_EQ(refusal_of({stranger}), std::string(stranger) + ": unknown option; " + allowed);
}

/// Whoever reads none of them is told at the end.
TEST(CommandLineTest, WhatBeginsAsPetscsOptionsDoIsLeftToPetsc) {
  for (const char* option :
       {"-log_view", "-info", "-malloc_debug", "-malloc", "-options_left", "-options_file", "-memory_view",
        "-on_error_abort", "-start_in_debugger", "-fp_trap", "-mat_view", "-elasticity_ksp_monitor",
        "-elasticity_mg_levels_ksp_max_it", "-heat_pc_typ", "-release_ksp_view", "-mg_levels_pc_type",
        "-use_gpu_aware_mpi", "-citations"})
    EXPECT_EQ(parse({"-config", "c", option}).petsc_arguments.back(), option);
}

TEST(CommandLineTest, RestartAndWallTime) {
  const CommandLine line = parse({"-config", "c", "-restart", "auto", "-max_wall_time", "1:30:00"});
  EXPECT_EQ(line.restart, "auto");
  EXPECT_EQ(line.max_wall_time, 5400.0);
  EXPECT_FALSE(parse({"-config", "c"}).restart);
  EXPECT_EQ(refusal_of({"-config", "c", "-max_wall_time", "soon"}),
            "-max_wall_time: found \"soon\"; allowed: a time > 0 as seconds or H:M:S");
  EXPECT_EQ(refusal_of({"-config", "c", "-restart"}), "-restart: missing value; allowed: -restart VALUE");
  EXPECT_NE(refusal_of({"-config", "c", "-restart", "a", "-task", "simulate"}).find("-task optimize"),
            std::string::npos);
  for (const char* directory : {"auto", "a"})
    EXPECT_NE(refusal_of({"-config", "c", "-restart", directory, "-overwrite"}).find("-overwrite"),
              std::string::npos);
  EXPECT_TRUE(parse({"-config", "c", "-restart", "a", "-output", "b", "-overwrite"}).overwrite);
}

TEST(CommandLineTest, EveryFlatOptionIsUniqueAndNamesAKey) {
  std::set<std::string> seen;
  for (const ConfigKey* key : keys_with_option()) {
    const std::string& option = key->option;
    EXPECT_TRUE(seen.insert(option).second) << option;
    EXPECT_EQ(option.front(), '-');
    const CommandLine line = parse({"-config", "c", option.c_str(), "1"});
    ASSERT_EQ(line.overrides.size(), 1U) << option;
    EXPECT_EQ(line.petsc_arguments.size(), 1U) << option;
  }
}

TEST(CommandLineTest, HelpAndReferenceNameEveryKey) {
  const std::string help = help_text(), reference = reference_table();
  std::set<std::string> sections;
  for (const SectionKeys& section : config_sections()) {
    EXPECT_TRUE(sections.insert(section.path).second) << section.path;
    for (const ConfigKey& key : section.keys) {
      EXPECT_EQ(key.section, section.path) << key.name;
      EXPECT_FALSE(key.meaning.empty()) << key.name;
      EXPECT_NE(help.find(key.meaning), std::string::npos) << key.name;
      EXPECT_NE(reference.find("- `" + key.name + "`"), std::string::npos) << key.name;
      if (!key.option.empty()) {
        EXPECT_NE(help.find("\n  " + key.option + " "), std::string::npos) << key.option;
      }
    }
  }
  for (const char* option : {"-restart DIR", "-max_wall_time TIME"})
    EXPECT_NE(help.find("\n  " + std::string(option)), std::string::npos) << option;
  const std::string young = "- `young`: Young's modulus. Default `1.0`; a number > 0 [stress]; `-young`.\n";
  EXPECT_NE(reference.find(young), std::string::npos);
  EXPECT_NE(reference.find("- `weight` (`build_time`, `distortion`, `segmentation_alignment`): "),
            std::string::npos);
  EXPECT_NE(reference.find("- `measure`, `nodes`, `to`, "), std::string::npos);
  EXPECT_NE(reference.find(" (`distortion`): as in"), std::string::npos);
}

}  // namespace
}  // namespace fabseq
