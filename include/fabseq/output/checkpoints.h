// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/phase_timer.h"
#include "fabseq/files/output_directory.h"
#include "fabseq/optimize/run_state.h"
#include "fabseq/output/restart.h"
#include "fabseq/output/run_clock.h"

#include <optional>

namespace fabseq {

/// The checkpoints of a run's directory (docs/reference.md, restart). All calls are collective; OutputError
/// on all ranks if one cannot be written.
template <int Dim>
class Checkpoints {
 public:
  /// All arguments must outlive the object.
  Checkpoints(const Setup<Dim>& setup, const OutputDirectory& directory, RunClock& clock, PhaseTimer& timer)
      : setup_(setup), directory_(directory), clock_(clock), timer_(timer) {}

  /// Takes over history, seconds and checkpoint of an earlier run.
  void continue_from(const Restart& restart);
  /// Keeps the state of run and pipeline between two iterations, and writes it when that is due, `asked` for,
  /// or the state is the last; returns whether it did.
  bool keep(const RunState<Dim>& run, const Pipeline<Dim>& pipeline, bool asked);
  /// Writes the state kept last, unless the directory has it already.
  void write();

  /// Iterations and design of the state kept last.
  int iteration() const { return kept_.integer("iteration"); }
  const std::vector<double>& design() const { return kept_.field("design"); }

 private:
  const Setup<Dim>& setup_;
  const OutputDirectory& directory_;
  RunClock& clock_;
  PhaseTimer& timer_;
  CheckpointState kept_;        ///< the state between the last two iterations
  std::optional<int> written_;  ///< iterations of the checkpoint in the directory, if it has one
  bool due_ = false;            ///< whatever the iteration
};

}  // namespace fabseq
