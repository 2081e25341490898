// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/error.h"
#include "fabseq/base/stop.h"
#include "fabseq/config/command_line.h"
#include "fabseq/config/setup.h"
#include "fabseq/optimize/best_iterate.h"
#include "fabseq/output/checkpoints.h"
#include "fabseq/output/restart.h"
#include "fabseq/output/result.h"
#include "fabseq/output/terminal.h"

#include <optional>
#include <string>

namespace fabseq {

/// Hands each event of a run to history, checkpoints, result and terminal (docs/reference.md, Output). All
/// calls are collective; OutputError on all ranks if something cannot be written.
template <int Dim>
class RunOutput {
 public:
  /// Makes the directory and writes config.json; goes on with the files of the run that is continued, if one
  /// is. Setup and timer must outlive the object.
  RunOutput(const Setup<Dim>& setup, const CommandLine& command_line, const RunPlace& place,
            const std::optional<Restart>& restart, PhaseTimer& timer);

  const OutputDirectory& directory() const { return directory_; }
  /// Keeps what is known of the designs that the run began with; null: it began with one.
  void set_starts(const Json& record);
  const Json& starts() const { return starts_; }
  /// Keeps the planar baseline for comparison, and says what it is.
  void baseline(SequenceReport report, const std::string& solver);
  /// One iteration: history, progress line, and a field dump when it is due or a file `output_now` asks for
  /// it.
  void iteration(const Iterate& iterate, const StepReport& step, Pipeline<Dim>& pipeline,
                 const StageResults<Dim>& state, const Design& design);
  /// Keeps the state between two iterations; returns whether a checkpoint was written (Checkpoints::keep()).
  bool keep(const RunState<Dim>& run, const Pipeline<Dim>& pipeline);
  /// result.h5, result.xdmf and summary.json, and the table on the screen.
  void finish(const RunEnd& end, const FinalReports& reports, const BestIterate& best);
  /// A run that ended on its coarse grid, which has left a directory of its own, has a summary all the same.
  void end_before_the_first(const std::string& status, const std::string& reason) {
    write_summary(summary({status, reason, 0}));
  }
  /// What is left of a run that was stopped: a checkpoint of the state last kept, and summary.json.
  void stop(const Stopped& reason);
  /// What is left of a run that failed: the same, and as much as there is of the fields of the failing
  /// iteration. If these cannot be written, that is a warning: the failure itself is what the user has to
  /// know.
  void fail(const NumericalError& error, const Pipeline<Dim>& pipeline);

 private:
  /// File by which a user asks for fields and a checkpoint of the iteration under way.
  static constexpr const char* output_request = "output_now";

  /// Takes over what the directory of an earlier run says of the designs that it began with.
  void continue_starts(const std::string& directory);
  Summary summary(const RunEnd& end) const;
  void write_summary(const Summary& summary) const;

  const Setup<Dim>& setup_;
  PhaseTimer& timer_;
  OutputDirectory directory_;
  StopFile stop_file_;
  RunClock clock_;
  Checkpoints<Dim> checkpoints_;
  Terminal terminal_;
  std::optional<SequenceReport> baseline_;
  Json starts_;         ///< of the summary
  bool asked_ = false;  ///< for fields and a checkpoint, by output_request
};

}  // namespace fabseq
