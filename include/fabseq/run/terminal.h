// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/optimize/best_iterate.h"
#include "fabseq/run/records.h"

#include <mpi.h>

#include <limits>
#include <string>

namespace fabseq {

/// What one line of progress says.
struct ProgressLine {
  int iteration = 0, max_iterations = 0;
  /// First objective term of the planar baseline divided by the current one; NaN without a baseline.
  double objective_ratio = std::numeric_limits<double>::quiet_NaN();
  double worst_constraint = std::numeric_limits<double>::quiet_NaN();  ///< relative; < 0: satisfied
  double beta = 0.0;
  double seconds = 0.0;  ///< of this iteration
};

/// Text of a line. The time left follows from `mean_seconds` per iteration.
std::string progress_text(const ProgressLine& line, double mean_seconds);

/// Whether standard output ends on a terminal. Open MPI gives its processes a pseudo-terminal whatever
/// mpirun's own output is: for a process that mpirun started, the answer is mpirun's.
bool stdout_is_terminal();

/// Prints a line per iteration on rank 0: on a terminal always the same line, rewritten; in a log file one
/// after the other.
class Progress {
 public:
  explicit Progress(MPI_Comm comm) : Progress(comm, stdout_is_terminal()) {}
  /// `on_terminal`: whether the line is rewritten (rank 0's counts).
  Progress(MPI_Comm comm, bool on_terminal);
  /// Ends the line, as finish().
  ~Progress() { finish(); }
  Progress(Progress&&) = delete;

  void print(const ProgressLine& line);
  /// Ends a line that would still be rewritten, so that other text can follow.
  void finish();

 private:
  bool is_first_, on_terminal_;
  double mean_seconds_ = 0.0;
  bool line_open_ = false;
};

/// A line per response, by the tasks that evaluate one design: its value, or the range of its components.
void print_responses(const SequenceNumbers& numbers);
/// Warns if the residual stress of a finished sequence is above the yield stress somewhere.
void warn_beyond_yield(const SequenceNumbers& numbers, const MaterialSettings& material);

/// What an optimization says on the terminal, on rank 0.
class Terminal {
 public:
  Terminal(MPI_Comm comm, int max_iterations) : progress_(comm), max_iterations_(max_iterations) {}

  /// The planar baseline, which later lines compare with.
  void baseline(const SequenceNumbers& planar);
  void iteration(const Iterate& iterate, double seconds);
  /// Ends the line of progress, so that other text can follow.
  void end_progress() { progress_.finish(); }
  /// All sequences of a run that was not interrupted (summary_table()), and how it ended.
  void table(const Summary& summary, const std::string& directory) const;

 private:
  Progress progress_;
  int max_iterations_;
  double planar_objective_ = 0.0;  ///< first objective term of the baseline
};

}  // namespace fabseq
