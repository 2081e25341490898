// SPDX-License-Identifier: MIT
/// \file
/// Everything an optimization leaves in its output directory (docs/reference.md, output).
#pragma once

#include "fabseq/base/error.h"
#include "fabseq/base/stop.h"
#include "fabseq/config/command_line.h"
#include "fabseq/files/history.h"
#include "fabseq/files/output_directory.h"
#include "fabseq/optimize/run_state.h"
#include "fabseq/run/progress.h"
#include "fabseq/run/restart.h"
#include "fabseq/run/sequence_report.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// Makes the directory of output_path(), writes config.json: the effective config with the key `run` (command
/// line, versions, ranks). `continues`: a run that is there goes
/// on. Collective.
template <int Dim>
OutputDirectory make_output_directory(const Setup<Dim>& setup, const CommandLine& command_line,
                                      bool continues = false);
/// Seconds of each phase and "total" as an object.
Json seconds_record(const std::array<double, phase_count>& phases, double total);

/// The three sequences a run ends with.
template <int Dim>
struct FinalReports {
  SequenceReport<Dim> optimized, binary;
  std::int64_t interior_minima = 0;
};

/// Writer of an optimization's files. All calls are collective; OutputError on all ranks if something cannot
/// be written.
template <int Dim>
class RunOutput {
 public:
  /// Makes the directory and writes config.json; goes on with the files of the run that is continued, if one
  /// is. All but `restart` must outlive the object.
  RunOutput(const Setup<Dim>& setup, const CommandLine& command_line, const std::optional<Restart>& restart,
            PhaseTimer& timer);

  const std::string& path() const { return directory_.path(); }
  /// Keeps the planar baseline for comparison, and says what it is.
  void baseline(SequenceReport<Dim> report, const std::string& solver);
  /// One iteration: history, progress line, and a field dump when it is due or a file `output_now` asks for
  /// it.
  void iteration(const Iterate& iterate, const StepReport& step, Pipeline<Dim>& pipeline,
                 const PipelineState<Dim>& state, const Design& design);
  /// Keeps the state of run and pipeline between two iterations for checkpoints, and writes one when it is
  /// due, asked for, or the state is the last; returns whether it did.
  bool keep(const RunState<Dim>& run, const Pipeline<Dim>& pipeline);
  /// result.h5, result.xdmf and summary.json, and the table on the screen.
  void finish(const RunEnd& end, const FinalReports<Dim>& reports, const BestIterate& best);
  /// A run that ended on its coarse grid, which has left a directory of its own, has a summary all the same.
  void end_before_the_first(const std::string& status, const std::string& reason) {
    write_end({status, reason, 0});
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

  void continue_from(const Restart& restart);
  void write_history(const Iterate& iterate, const StepReport& step, const Pipeline<Dim>& pipeline,
                     const PipelineState<Dim>& state, const Design& design, double total);
  void dump_fields(int iteration, const Pipeline<Dim>& pipeline, const PipelineState<Dim>& state,
                   const Design& design);
  void write_result(const FinalReports<Dim>& reports, const BestIterate& best);
  void write_checkpoint();
  void dump_failure(const Pipeline<Dim>& pipeline);
  void write_end(const RunEnd& end);
  double total_seconds() const { return earlier_seconds_ + MPI_Wtime() - start_; }
  Json summary(const RunEnd& end) const;
  void print_table(const FinalReports<Dim>& reports, const Json& summary) const;

  const Setup<Dim>& setup_;
  PhaseTimer& timer_;
  OutputDirectory directory_;
  StopFile stop_file_;
  History history_;
  Progress progress_;
  SequenceReport<Dim> baseline_;
  std::array<double, phase_count> phase_seconds_{};  ///< of the iterations so far
  double start_, iteration_start_;
  double earlier_seconds_ = 0.0;     ///< of the run that this one continues
  CheckpointState kept_;             ///< the state between the last two iterations
  std::optional<int> checkpointed_;  ///< iterations of the checkpoint in the directory, if it has one
  bool asked_ = false;               ///< for fields and a checkpoint, by output_request
  bool checkpoint_due_ = false;      ///< whatever the iteration
};

extern template class RunOutput<2>;
extern template class RunOutput<3>;

}  // namespace fabseq
