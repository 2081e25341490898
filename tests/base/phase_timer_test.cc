// SPDX-License-Identifier: MIT
/// Seconds by phase.
#include "fabseq/base/phase_timer.h"

#include <gtest/gtest.h>
#include <mpi.h>

#include <chrono>
#include <numeric>
#include <thread>

namespace fabseq {
namespace {

void wait(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

double of(const PhaseTimer& timer, Phase phase) { return timer.seconds()[static_cast<int>(phase)]; }

TEST(PhaseTimerTest, ScopesInsideCountForTheirOwnPhase) {
  PhaseTimer timer;
  const double start = MPI_Wtime();
  {
    const auto heat = timer.enter(Phase::heat);
    for (int k = 0; k < 2; ++k) {
      const auto layers = timer.enter(Phase::layers);
      wait(0.05);
      const auto responses = timer.enter(Phase::responses);
      wait(0.1);
    }
  }
  const double elapsed = MPI_Wtime() - start;
  EXPECT_GE(of(timer, Phase::layers), 0.1);
  EXPECT_GE(of(timer, Phase::responses), 0.2);
  EXPECT_GE(of(timer, Phase::heat), 0.0);
  const auto& seconds = timer.seconds();
  EXPECT_LE(std::accumulate(seconds.begin(), seconds.end(), 0.0), elapsed * (1.0 + 1e-9));
  timer.reset();
  EXPECT_EQ(of(timer, Phase::layers), 0.0);
}

}  // namespace
}  // namespace fabseq
