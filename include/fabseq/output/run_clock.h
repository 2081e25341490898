// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/base/phase_timer.h"
#include "fabseq/files/checkpoint_state.h"

#include <array>

namespace fabseq {

/// Seconds of each phase, and of all of them with what lies between.
struct Seconds {
  std::array<double, phase_count> phases{};
  double total = 0.0;
};

/// One member per phase, and "total".
Json seconds_record(const Seconds& seconds);

/// Sums up the phases of all iterations, also of those of the run that this one continues.
class RunClock {
 public:
  /// The timer must outlive the clock.
  explicit RunClock(PhaseTimer& timer);

  /// Begins the iterations: until then, phases count for nothing.
  void begin_iterations();
  /// Ends an iteration; returns its seconds.
  Seconds end_iteration();
  /// Phases of the iterations so far, and the time since the beginning.
  Seconds so_far() const;

  void save(CheckpointState& state) const;
  void restore(const CheckpointState& state);

 private:
  PhaseTimer& timer_;
  Seconds earlier_;  ///< phases of all iterations so far, total of the run that is continued
  double start_, iteration_start_;
};

}  // namespace fabseq
