/// \file
/// Everything an optimization leaves in its output directory (docs/users-guide.md, output directory).
#pragma once

#include "fabseq/io/command_line.h"
#include "fabseq/io/history.h"
#include "fabseq/io/output_directory.h"
#include "fabseq/io/progress.h"
#include "fabseq/optimize/best_iterate.h"
#include "fabseq/optimize/design_update.h"
#include "fabseq/optimize/sequence_report.h"

#include <memory>
#include <string>
#include <vector>

namespace fabseq {

/// Makes the directory that -output names and writes config.json: the effective config with the key `run`
/// (command line, versions, ranks). Collective.
OutputDirectory make_output_directory(const Config& config, const CommandLine& command_line, MPI_Comm comm);
/// Seconds of each phase and "total" as an object.
Json seconds_record(const std::array<double, phase_count>& phases, double total);

/// How a run ended.
struct RunEnd {
  std::string status;  ///< converged, iteration_limit, failed
  std::string reason;
  int iterations = 0;
};

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
  /// Makes the directory and writes config.json. Everything must outlive the object.
  RunOutput(const Setup<Dim>& setup, const CommandLine& command_line, PhaseTimer& timer);

  const std::string& path() const { return directory_.path(); }
  /// Keeps the planar baseline for comparison, and says what it is.
  void baseline(SequenceReport<Dim> report, const std::string& solver);
  /// One iteration: history, progress line, field dump and checkpoint when they are due.
  void iteration(int iteration, double beta, const ProblemValues& values, const StepReport& step,
                 Pipeline<Dim>& pipeline, const PipelineState<Dim>& state, const std::vector<double>& design);
  /// result.h5, result.xdmf and summary.json, and the table on the screen.
  void finish(const RunEnd& end, const FinalReports<Dim>& reports, const BestIterate& best);
  /// What is left of a run that failed: a checkpoint of the design that could not be evaluated, and
  /// summary.json. If these cannot be written, that is a warning: the failure itself is what the user has to
  /// know.
  void fail(const RunEnd& end, double beta, const std::vector<double>& design);

 private:
  void write_history(int iteration, double beta, const ProblemValues& values, const StepReport& step,
                     const Pipeline<Dim>& pipeline, const PipelineState<Dim>& state, double total);
  void dump_fields(int iteration, const PipelineState<Dim>& state, const std::vector<double>& design);
  void write_result(const FinalReports<Dim>& reports, const BestIterate& best);
  void write_design_checkpoint(int iteration, double beta, const std::vector<double>& design);
  Json summary(const RunEnd& end) const;
  void print_table(const FinalReports<Dim>& reports, const Json& summary) const;

  const Setup<Dim>& setup_;
  PhaseTimer& timer_;
  OutputDirectory directory_;
  History history_;
  Progress progress_;
  SequenceReport<Dim> baseline_;
  std::array<double, phase_count> phase_seconds_{};  ///< of the iterations so far
  double start_, iteration_start_;
};

extern template class RunOutput<2>;
extern template class RunOutput<3>;

}  // namespace fabseq
