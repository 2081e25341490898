// SPDX-License-Identifier: MIT
/// Runs GoogleTest between PetscInitialize and PetscFinalize on any number of ranks; a failure on one rank
/// fails them all.
#include "fabseq/base/mpi.h"
#include "fabseq/base/session.h"

#include <gtest/gtest.h>
#include <petscsys.h>

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  int failed = 1;
  const int status = fabseq::run_session({argv[0]}, [&] {
    if (fabseq::rank_of(PETSC_COMM_WORLD) != 0) {
      auto& listeners = testing::UnitTest::GetInstance()->listeners();
      delete listeners.Release(listeners.default_result_printer());
    }
    const int local = RUN_ALL_TESTS();
    failed = fabseq::any(PETSC_COMM_WORLD, local != 0) ? 1 : 0;
  });
  return status != 0 ? status : failed;
}
