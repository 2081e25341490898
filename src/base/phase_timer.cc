// SPDX-License-Identifier: MIT
#include "fabseq/base/phase_timer.h"

#include "fabseq/base/log_event.h"
#include "fabseq/base/petsc.h"

#include <mpi.h>

#include <string>
#include <utility>

namespace fabseq {

PhaseTimer::PhaseTimer() {
  for (int phase = 0; phase < phase_count; ++phase) {
    const std::string name = "fabseq " + std::string(phase_names[phase]);
    check(PetscLogStageGetId(name.c_str(), &stages_[phase]));
    if (stages_[phase] < 0) check(PetscLogStageRegister(name.c_str(), &stages_[phase]));
  }
  // All events are registered now: PETSc matches the events of different ranks by number, and each layer
  // group would otherwise register them in an order of its own.
  for (const char* name : {"fabseq heat lanes", "fabseq lane set-up", "fabseq loads", "fabseq lane solve",
                           "fabseq derivatives", "fabseq set-up", "fabseq solve", "fabseq block solve"})
    (void)LogEvent(name);
}

PhaseTimer::Scope::Scope(PhaseTimer& timer, Phase phase)
    : timer_(timer), phase_(phase), start_(MPI_Wtime()), inner_before_(std::exchange(timer.inner_, 0.0)) {
  check(PetscLogStagePush(timer_.stages_[static_cast<int>(phase_)]));
}

PhaseTimer::Scope::~Scope() {
  (void)PetscLogStagePop();
  const double elapsed = MPI_Wtime() - start_;
  timer_.seconds_[static_cast<int>(phase_)] += elapsed - timer_.inner_;
  timer_.inner_ = inner_before_ + elapsed;
}

}  // namespace fabseq
