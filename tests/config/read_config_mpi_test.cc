// SPDX-License-Identifier: MIT
/// Reading a config on several ranks: rank 0 reads, all ranks agree on config and errors.
#include "fabseq/base/mpi.h"
#include "fabseq/config/command_line.h"
#include "support/refusal.h"

#include <gtest/gtest.h>
#include <petscsys.h>

#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace fabseq {
namespace {

constexpr const char* plain = R"({  // a comment
  "domain": {"size": [2, 1], "elements": [8, 4]},
  "part": {"box": {"min": [0, 0], "max": [2, 1]}},
  "sequence": {"type": "heat"}, "layers": {"count": 4},
  "objective": [{"type": "distortion", "measure": "layerwise"}]
})";

/// A folder of rank 0's, gone after the test.
class ReadConfigTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto name = "fabseq_read_config_" + std::to_string(::getpid());
    folder_ = broadcast(PETSC_COMM_WORLD, (std::filesystem::temp_directory_path() / name).string());
    if (rank_of(PETSC_COMM_WORLD) == 0) std::filesystem::create_directories(folder_);
    write("config.json", plain);
  }
  void TearDown() override {
    MPI_Barrier(PETSC_COMM_WORLD);
    if (rank_of(PETSC_COMM_WORLD) == 0) std::filesystem::remove_all(folder_);
  }

  void write(const std::string& name, const std::string& text) const {
    if (rank_of(PETSC_COMM_WORLD) == 0) std::ofstream(folder_ + "/" + name) << text;
    MPI_Barrier(PETSC_COMM_WORLD);
  }

  Config read(const std::vector<std::string>& settings, Task task = Task::optimize,
              const std::string& file = "config.json") const {
    CommandLine line;
    line.config_file = folder_ + "/" + file;
    line.task = task;
    for (const std::string& setting : settings) {
      const std::size_t equals = setting.find('=');
      line.overrides.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
    }
    return read_config(PETSC_COMM_WORLD, line);
  }

  /// The error of this rank after making sure that all ranks have the same.
  std::string error_of(const std::vector<std::string>& settings, Task task = Task::optimize,
                       const std::string& file = "config.json") const {
    const std::string text = test::refusal([&] { (void)read(settings, task, file); });
    const bool same = text == broadcast(PETSC_COMM_WORLD, text);
    EXPECT_FALSE(any(PETSC_COMM_WORLD, !same));
    return text;
  }

  std::string folder_;
};

TEST_F(ReadConfigTest, AllRanksGetTheSame) {
  const Config config = read({"layers.count=6", "name=plain"});
  EXPECT_EQ(config.layers.count, 6);
  EXPECT_EQ(config.name, "plain");
  const std::string text = config.effective.dump();
  EXPECT_EQ(text, broadcast(PETSC_COMM_WORLD, text));
}

TEST_F(ReadConfigTest, PathsAreRelativeToTheConfigFile) {
  write("part.h5", "not looked into here");
  const Config config = read({R"(part={"voxels": {"file": "x/../part.h5"}})"});
  EXPECT_EQ(std::get<VoxelFile>(config.part.source).file,
            (std::filesystem::canonical(folder_) / "part.h5").string());
}

TEST_F(ReadConfigTest, FilesThatCannotBeRead) {
  const std::string message = error_of({}, Task::optimize, "none.json");
  EXPECT_EQ(message, "-config: cannot read \"" + folder_ +
                         "/none.json\" (No such file or directory); allowed: a readable JSON file");
  EXPECT_NE(error_of({}, Task::optimize, ".").find("(is a directory)"), std::string::npos);
  const std::string canonical = std::filesystem::canonical(folder_).string();
  const std::string rest = "which cannot be read (No such file or directory); allowed: a readable HDF5 file";
  EXPECT_EQ(error_of({R"(part={"voxels": {"file": "none.h5"}})"}),
            "/part/voxels/file: found \"" + canonical + "/none.h5\", " + rest);
  EXPECT_EQ(error_of({R"(sequence={"type": "file", "file": "t.h5"})"}, Task::simulate),
            "/sequence/file: found \"" + canonical + "/t.h5\", " + rest);
}

TEST_F(ReadConfigTest, MalformedTextNamesFileAndLine) {
  write("broken.json", "{\n\"domain\": }");
  const std::string message = error_of({}, Task::optimize, "broken.json");
  EXPECT_EQ(message.rfind(folder_ + "/broken.json: line 2, column 11: ", 0), 0U) << message;
}

TEST_F(ReadConfigTest, TasksNeedWhatTheyNeed) {
  EXPECT_EQ(error_of({"objective=[]"}),
            "/objective: found []; allowed: at least one term with -task optimize");
  EXPECT_EQ(error_of({"objective=[]"}, Task::simulate), "no error");
  EXPECT_EQ(error_of({R"(sequence={"type": "planar"})"}, Task::simulate), "no error");
  EXPECT_EQ(
      error_of({R"(sequence={"type": "planar"})"}),
      "/sequence/type: found \"planar\", which has nothing to vary; allowed: heat, direct, guided with -task "
      "optimize, "
      "all with "
      "-task simulate");
  EXPECT_EQ(
      error_of({"projection.binary=true"}, Task::check_gradients),
      "/projection/binary: found true; allowed: false with -task check_gradients, which needs derivatives");
  EXPECT_EQ(error_of({"projection.binary=true"}, Task::evaluate), "no error");
}

TEST_F(ReadConfigTest, WeakStrainPenaltyIsAWarning) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(read({"process.strain_penalty=2"}).process.strain_penalty, 2.0);
  const std::string warning = testing::internal::GetCapturedStderr();
  if (rank_of(PETSC_COMM_WORLD) == 0) {
    EXPECT_EQ(
        warning,
        "warning: /process/strain_penalty: found 2, less than stiffness_penalty (3.0): half-built elements "
        "shrink more than they resist\n");
  } else {
    EXPECT_EQ(warning, "");
  }
}

}  // namespace
}  // namespace fabseq
