// SPDX-License-Identifier: MIT
/// Runs GoogleTest between PetscInitialize and PetscFinalize on any number of ranks; a failure on one rank
/// fails them all. `--file=NAME_test.cc` runs the tests of this file; that there are none is an error. With
/// FABSEQ_NO_SKIPS, a skipped test is an error unless it is one of other rank counts
/// ("ranks: ...") or the regular expression FABSEQ_MAY_SKIP matches the reason.
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"

#include <gtest/gtest.h>
#include <petscsys.h>

#include <cstdlib>
#include <iostream>
#include <regex>
#include <string>

namespace {

class NoSkips : public testing::EmptyTestEventListener {
 public:
  bool broken() const { return broken_; }

 private:
  void OnTestPartResult(const testing::TestPartResult& result) override {
    const std::string reason = result.message();
    if (!result.skipped() || reason.find("ranks: ") != std::string::npos) return;
    const char* allowed = std::getenv("FABSEQ_MAY_SKIP");
    if (allowed != nullptr && *allowed != '\0' && std::regex_search(reason, std::regex(allowed))) return;
    std::cerr << "error: a test was skipped: " << reason << "\n";
    broken_ = true;
  }

  bool broken_ = false;
};

/// Chooses the tests of a source file: GoogleTest knows only their names.
bool select_file(const std::string& file) {
  const auto& all = *testing::UnitTest::GetInstance();
  std::string filter;
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const auto& suite = *all.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const auto& test = *suite.GetTestInfo(t);
      if (std::string(test.file()).ends_with("/" + file))
        filter += std::string(suite.name()) + "." + test.name() + ":";
    }
  }
  GTEST_FLAG_SET(filter, filter);
  if (filter.empty()) std::cerr << "error: no test in a file " << file << "\n";
  return !filter.empty();
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::string option = argc > 1 ? argv[1] : "", file = "--file=";
  if (option.starts_with(file) && !select_file(option.substr(file.size()))) return 2;
  int failed = 1;
  const int status = fabseq::run_session({argv[0]}, [&] {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    if (fabseq::rank_of(PETSC_COMM_WORLD) != 0) delete listeners.Release(listeners.default_result_printer());
    NoSkips no_skips;
    if (std::getenv("FABSEQ_NO_SKIPS") != nullptr) listeners.Append(&no_skips);
    const bool local = RUN_ALL_TESTS() != 0 || no_skips.broken();
    listeners.Release(&no_skips);
    failed = fabseq::any(PETSC_COMM_WORLD, local) ? 1 : 0;
  });
  return status != 0 ? status : failed;
}
