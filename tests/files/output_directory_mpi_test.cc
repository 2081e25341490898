// SPDX-License-Identifier: MIT
#include "fabseq/base/verdict.h"
#include "fabseq/files/history.h"
#include "fabseq/output/terminal.h"
#include "support/io_support.h"

#include <cstdio>

namespace fabseq {
namespace {

namespace fs = std::filesystem;
using test::contains;
using test::error_text;
using test::file_text;
using test::is_first;

void put(const std::string& path, const std::string& text = "x") {
  if (!is_first()) return;
  fs::create_directories(fs::path(path).parent_path());
  std::ofstream(path) << text;
}

/// Everything in a directory, sorted, for rank 0; the others get the same list.
std::string listing(const std::string& path) {
  std::vector<std::string> names;
  if (is_first())
    for (const auto& entry : fs::recursive_directory_iterator(path))
      names.push_back(fs::relative(entry.path(), path).string());
  std::sort(names.begin(), names.end());
  std::string text;
  for (const std::string& name : names) text += name + " ";
  return broadcast(PETSC_COMM_WORLD, text);
}

TEST(OutputDirectory, MakesParentsAndWritesWholeFiles) {
  const test::ScratchDirectory scratch;
  const OutputDirectory directory(PETSC_COMM_WORLD, scratch.file("a/b"), false);
  EXPECT_EQ(directory.file("x"), scratch.file("a/b/x"));
  directory.write("config.json", "{}\n");
  directory.write("config.json", "{\"a\": 1}\n");
  directory.make_folder("fields");
  directory.make_folder("fields");
  directory.write("fields/x.txt", is_first() ? "of rank 0" : "of another");
  if (is_first()) {
    EXPECT_EQ(file_text(directory.file("config.json")), "{\"a\": 1}\n");
    EXPECT_EQ(file_text(directory.file("fields/x.txt")), "of rank 0");
  }
  EXPECT_EQ(listing(directory.path()), "config.json fields fields/x.txt lock ");
}

TEST(OutputDirectory, RefusesToTouchAnEarlierRun) {
  const test::ScratchDirectory scratch;
  put(scratch.file("config.json"));
  put(scratch.file("result.h5"));
  MPI_Barrier(PETSC_COMM_WORLD);
  const std::string text =
      error_text<InputError>([&] { OutputDirectory(PETSC_COMM_WORLD, scratch.path(), false); });
  EXPECT_TRUE(contains(text, scratch.path()) && contains(text, "-overwrite")) << text;
  EXPECT_EQ(listing(scratch.path()), "config.json result.h5 ");
}

TEST(OutputDirectory, UsesADirectoryWithoutARun) {
  const test::ScratchDirectory scratch;
  put(scratch.file("notes.txt"));
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_NO_THROW(OutputDirectory(PETSC_COMM_WORLD, scratch.path(), false));
  EXPECT_EQ(listing(scratch.path()), "notes.txt ");
}

TEST(OutputDirectory, OverwritingRemovesWhatARunWroteAndNothingElse) {
  const test::ScratchDirectory scratch;
  for (const char* name :
       {"config.json", "history.jsonl", "summary.json", "result.h5", "result.xdmf", "result.h5.partial",
        "stop", "output_now", "fields/iteration_0015.bin", "fields/iteration_0015.xdmf",
        "fields/iteration_0030.bin.partial", "checkpoint/slot_0.h5", "checkpoint/slot_1.h5",
        "checkpoint/newest", "notes.txt", "fields/mine.bin", "other/result.h5"})
    put(scratch.file(name));
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_NO_THROW(OutputDirectory(PETSC_COMM_WORLD, scratch.path(), true));
  EXPECT_EQ(listing(scratch.path()), "fields fields/mine.bin notes.txt other other/result.h5 ");
}

TEST(OutputDirectory, FailsOnAllRanksWhereNothingCanBeMade) {
  const test::ScratchDirectory scratch;
  put(scratch.file("file"));
  MPI_Barrier(PETSC_COMM_WORLD);
  for (const std::string& path :
       {scratch.file("file"), scratch.file("file/below"), std::string("/proc/fabseq/out")})
    for (const bool overwrite : {false, true}) {
      const std::string text =
          error_text<OutputError>([&] { OutputDirectory(PETSC_COMM_WORLD, path, overwrite); });
      EXPECT_TRUE(contains(text, path)) << text;
    }
}

TEST(OutputDirectory, FailsOnAllRanksWhenTheDiskIsFull) {
  const test::SmallDisk disk("64k");
  if (!disk.mounted()) GTEST_SKIP() << "needs the privilege to mount a tmpfs";
  const OutputDirectory directory(PETSC_COMM_WORLD, disk.path(), false);
  directory.write("summary.json", "first");
  append_to_history(directory, Json::object({{"iteration", 1}}));
  const std::string large(200000, 'x');
  std::string text = error_text<OutputError>([&] { directory.write("summary.json", large); });
  EXPECT_TRUE(contains(text, "summary.json") && contains(text, "No space left")) << text;
  text = error_text<OutputError>([&] { append_to_history(directory, large); });
  EXPECT_TRUE(contains(text, "history.jsonl")) << text;
  if (is_first()) {
    EXPECT_EQ(file_text(directory.file("summary.json")), "first");
    EXPECT_EQ(file_text(directory.file("history.jsonl")), "{\"iteration\":1}\n");
  }
  EXPECT_EQ(listing(disk.path()), "history.jsonl lock summary.json ");
  // With room again, the run could go on.
  EXPECT_NO_THROW(append_to_history(directory, Json::object({{"iteration", 2}})));
}

TEST(History, HoldsOneObjectALineReadableAtOnce) {
  const test::ScratchDirectory scratch;
  const OutputDirectory directory(PETSC_COMM_WORLD, scratch.path(), false);
  for (int iteration = 1; iteration <= 3; ++iteration) {
    Json entry = Json::object({{"iteration", Json(iteration)}, {"objective", Json(0.1 * iteration)}});
    entry["rank"] = Json(rank_of(PETSC_COMM_WORLD));
    append_to_history(directory, entry);
    if (!is_first()) continue;
    std::istringstream lines(file_text(directory.file("history.jsonl")));
    std::string line, last;
    int count = 0;
    while (std::getline(lines, line)) {
      last = line;
      ++count;
    }
    EXPECT_EQ(count, iteration);
    const Json read = parse_json(last, "history");
    EXPECT_EQ(read.at("iteration").get<std::int64_t>(), iteration);
    EXPECT_EQ(read.at("objective").get<double>(), 0.1 * iteration);
    EXPECT_EQ(read.at("rank").get<std::int64_t>(), 0);
  }
}

TEST(History, GoesBackToAPosition) {
  const test::ScratchDirectory scratch;
  const OutputDirectory directory(PETSC_COMM_WORLD, scratch.file("a"), false);
  const OutputDirectory other(PETSC_COMM_WORLD, scratch.file("b"), false);
  EXPECT_EQ(sync_history(directory), 0);
  append_to_history(directory, Json::object({{"iteration", 1}}));
  const std::int64_t position = sync_history(directory);
  append_to_history(directory, Json::object({{"iteration", 2}}));
  copy_history(other, directory.path(), position);
  cut_history(directory, position);
  if (is_first()) {
    EXPECT_EQ(file_text(directory.file("history.jsonl")), "{\"iteration\":1}\n");
    EXPECT_EQ(file_text(other.file("history.jsonl")), "{\"iteration\":1}\n");
  }
  testing::internal::CaptureStderr();
  cut_history(directory, position + 1);
  EXPECT_EQ(contains(testing::internal::GetCapturedStderr(), "history.jsonl has lost lines"), is_first());
  EXPECT_EQ(sync_history(directory), position);
}

TEST(OutputDirectory, AContinuedRunKeepsItsFiles) {
  const test::ScratchDirectory scratch;
  for (const char* name : {"config.json", "history.jsonl", "summary.json", "result.h5", "result.h5.partial",
                           "stop", "checkpoint/slot_0.h5", "checkpoint/slot_1.h5.partial", "notes.txt"})
    put(scratch.file(name));
  MPI_Barrier(PETSC_COMM_WORLD);
  const OutputDirectory directory = OutputDirectory::continued(PETSC_COMM_WORLD, scratch.path());
  EXPECT_EQ(listing(scratch.path()),
            "checkpoint checkpoint/slot_0.h5 config.json history.jsonl lock notes.txt result.h5 stop ");
  EXPECT_TRUE(directory.has("stop"));
  directory.remove("stop");
  directory.remove("stop");
  EXPECT_FALSE(directory.has("stop"));
}

TEST(OutputDirectory, IsNotMadeAgainOnceItHasVanished) {
  const test::ScratchDirectory scratch;
  const OutputDirectory directory(PETSC_COMM_WORLD, scratch.file("run"), false);
  if (is_first()) fs::remove_all(scratch.file("run"));
  MPI_Barrier(PETSC_COMM_WORLD);
  for (const std::string& text :
       {error_text<OutputError>([&] { directory.make_folder("fields"); }),
        error_text<OutputError>([&] { append_to_history(directory, Json::object()); })})
    EXPECT_TRUE(contains(text, "No such file or directory")) << text;
  EXPECT_EQ(listing(scratch.path()), "");
}

TEST(Verdict, LowestFailingRankSpeaksForAll) {
  const int rank = rank_of(PETSC_COMM_WORLD), ranks = size_of(PETSC_COMM_WORLD);
  EXPECT_NO_THROW(run_on_all(PETSC_COMM_WORLD, [] {}));
  const int first = ranks > 1 ? 1 : 0;
  EXPECT_EQ(error_text<Stopped>([] { run_on_first(PETSC_COMM_WORLD, [] { throw Stopped("stopped"); }); }),
            "stopped");
  const std::string text = error_text<InputError>([&] {
    run_on_all(PETSC_COMM_WORLD, [&] {
      if (rank >= first) throw InputError("rank " + std::to_string(rank));
    });
  });
  EXPECT_EQ(text, "rank " + std::to_string(first));
  EXPECT_EQ(error_text<NumericalError>(
                [] { run_on_first(PETSC_COMM_WORLD, [] { throw NumericalError("diverged"); }); }),
            "diverged");
  EXPECT_EQ(error_text<OutputError>(
                [] { run_on_first(PETSC_COMM_WORLD, [] { throw std::runtime_error("anything else"); }); }),
            "anything else");
}

/// What is printed of planar layers with an objective of 29 and of an iteration after them.
std::string progress_text(const Iterate& iterate) {
  Terminal terminal(PETSC_COMM_WORLD, 400, false);
  SequenceNumbers planar;
  planar.responses = {{"objective_0", "distortion", 29.0}};
  testing::internal::CaptureStdout();
  terminal.baseline(planar);
  terminal.iteration(iterate, 10.0);
  return testing::internal::GetCapturedStdout();
}

TEST(Terminal, SaysWhereTheRunIs) {
  Iterate iterate;
  iterate.iteration = 7;
  iterate.beta = 100.0;
  const std::string baseline = "planar baseline: 0 layers, first objective term 2.9000e+01\n";
  const std::string begin = baseline + "iteration   7/400",
                    end = "  beta 100  10 s/iteration  left 1:05:30\n";
  EXPECT_EQ(progress_text(iterate), is_first() ? begin + end : "");
  iterate.values.objective = {{5.0}};
  iterate.values.constraints = {{0.3}};
  iterate.values.worst_constraint = -0.02;
  EXPECT_EQ(progress_text(iterate), is_first() ? begin + "  planar/objective 5.8  limits kept" + end : "");
}

TEST(Terminal, RewritesItsLineAndAppendsToALog) {
  Iterate iterate;
  for (const bool on_terminal : {false, true}) {
    testing::internal::CaptureStdout();
    {
      Terminal terminal(PETSC_COMM_WORLD, 2, on_terminal);
      for (iterate.iteration = 1; iterate.iteration <= 2; ++iterate.iteration)
        terminal.iteration(iterate, 1.0);
    }
    const std::string text = testing::internal::GetCapturedStdout();
    const std::string first = "iteration 1/2  beta 0  1 s/iteration  left 0:00:01";
    const std::string second = "iteration 2/2  beta 0  1 s/iteration  left 0:00:00";
    const std::string expected =
        on_terminal ? "\r" + first + "\033[K\r" + second + "\033[K\n" : first + "\n" + second + "\n";
    EXPECT_EQ(text, is_first() ? expected : "");
  }
}

}  // namespace
}  // namespace fabseq
