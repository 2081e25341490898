// SPDX-License-Identifier: MIT
#pragma once

#include <petscsys.h>

#include <array>
#include <string_view>

namespace fabseq {

enum class Phase { heat, layers, primal, adjoint, responses, optimizer, output };
constexpr int phase_count = 7;
constexpr std::array<std::string_view, phase_count> phase_names = {
    "heat", "layers", "primal", "adjoint", "responses", "optimizer", "output"};

/// Where the time of a run goes: wall seconds spent in each phase, on this rank; each phase is a stage of
/// PETSc's -log_view.
class PhaseTimer {
 public:
  /// Registers the log stages and events; PETSc must be initialized.
  PhaseTimer();

  /// Time from construction to destruction counts for the phase. Phases do not nest.
  class Scope {
   public:
    Scope(PhaseTimer& timer, Phase phase);
    ~Scope();
    Scope(Scope&&) = delete;

   private:
    PhaseTimer& timer_;
    Phase phase_;
    double start_;
  };
  [[nodiscard]] Scope enter(Phase phase) { return Scope(*this, phase); }

  /// Seconds a phase since construction or the last reset().
  const std::array<double, phase_count>& seconds() const { return seconds_; }
  void reset() { seconds_.fill(0.0); }

 private:
  std::array<double, phase_count> seconds_{};
  std::array<PetscLogStage, phase_count> stages_{};
};

}  // namespace fabseq
