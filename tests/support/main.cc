// SPDX-License-Identifier: MIT
/// Runs GoogleTest between PetscInitialize and PetscFinalize on any number of ranks; a failure on one rank
/// fails them all. With FABSEQ_NO_SKIPS, a skipped test is an error unless it is one of other rank counts
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

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
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
