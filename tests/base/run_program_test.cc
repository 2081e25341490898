// SPDX-License-Identifier: MIT
#include "fabseq/base/run_program.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <string>

namespace fabseq {
namespace {

std::string of_shell(const std::string& text, double most_seconds = 60.0) {
  return run_program({"/bin/sh", "-c", text}, most_seconds);
}

TEST(RunProgramTest, SaysWhyAProgramFailed) {
  EXPECT_EQ(of_shell("echo printed; echo warned >&2"), "");
  EXPECT_EQ(of_shell("echo first >&2; echo last >&2; echo >&2; exit 2"), "last");
  EXPECT_EQ(of_shell("exit 3"), "/bin/sh ended with status 3");
  EXPECT_EQ(of_shell("kill -9 $$"), "/bin/sh was ended by signal 9");
  EXPECT_EQ(run_program({"/no/such/program"}, 60.0),
            "/no/such/program does not start: No such file or directory");
}

TEST(RunProgramTest, TakesNoShellAndGivesNoInput) {
  EXPECT_EQ(run_program({"/bin/sh", "-c", "test \"$1\" = '$HOME *'", "sh", "$HOME *"}, 60.0), "");
  EXPECT_EQ(of_shell("test -z \"$(cat)\""), "");
}

TEST(RunProgramTest, LeavesOutTheVariablesOfMpi) {
  for (const char* name : {"OMPI_TEST", "PMIX_TEST", "PMI_TEST", "MPI_TEST", "OTHER_TEST"})
    ASSERT_EQ(::setenv(name, "1", 1), 0);
  EXPECT_EQ(of_shell("test -z \"$OMPI_TEST$PMIX_TEST$PMI_TEST$MPI_TEST\" && test \"$OTHER_TEST\" = 1"), "");
  for (const char* name : {"OMPI_TEST", "PMIX_TEST", "PMI_TEST", "MPI_TEST", "OTHER_TEST"})
    (void)::unsetenv(name);
}

TEST(RunProgramTest, EndsAProgramThatHangs) {
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(of_shell("exec sleep 60", 0.2), "it took too long");
  EXPECT_EQ(of_shell("while true; do echo more >&2; done", 0.2), "it took too long");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

}  // namespace
}  // namespace fabseq
