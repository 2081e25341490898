// SPDX-License-Identifier: MIT
#pragma once

#include <petscsys.h>

#include <array>
#include <string_view>

namespace fabseq {

/// Phases of a run, in the order of phase_names.
enum class Phase { heat, layers, primal, adjoint, responses, optimizer, output };
constexpr int phase_count = 7;
constexpr std::array<std::string_view, phase_count> phase_names = {
    "heat", "layers", "primal", "adjoint", "responses", "optimizer", "output"};

/// Wall seconds that this rank has spent in each phase of a run. Each phase is a stage of PETSc's -log_view.
class PhaseTimer {
 public:
  /// Registers the log stages and events; PETSc must be initialized.
  PhaseTimer();

  /// The time between construction and destruction counts for the phase, but for that of scopes inside.
  class Scope {
   public:
    Scope(PhaseTimer& timer, Phase phase);
    ~Scope();
    Scope(Scope&&) = delete;

   private:
    PhaseTimer& timer_;
    Phase phase_;
    double start_, inner_before_;
  };
  [[nodiscard]] Scope enter(Phase phase) { return Scope(*this, phase); }

  /// Seconds per phase since construction or the last reset(), in the order of Phase.
  const std::array<double, phase_count>& seconds() const { return seconds_; }
  void reset() { seconds_.fill(0.0); }

 private:
  std::array<double, phase_count> seconds_{};
  double inner_ = 0.0;  ///< of the scopes that have ended inside the present one
  std::array<PetscLogStage, phase_count> stages_{};
};

}  // namespace fabseq
