// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/optimize/best_iterate.h"
#include "fabseq/output/records.h"

#include <mpi.h>

#include <string>

namespace fabseq {

/// Whether standard output ends on a terminal. Open MPI gives its processes a pseudo-terminal whatever
/// mpirun's own output is: for a process that mpirun started, the answer is mpirun's.
bool stdout_is_terminal();

/// A line per response, by the tasks that evaluate one design: its value, or the range of its components.
void print_responses(const SequenceNumbers& numbers);
/// A line per sentence of the finding of that name, if there are any.
void print_words(const SequenceNumbers& numbers, const std::string& finding);

/// What an optimization says on the terminal, on rank 0.
class Terminal {
 public:
  /// `on_terminal`: whether progress is always the same line, rewritten (rank 0's counts); in a log file it
  /// is one line after the other.
  Terminal(MPI_Comm comm, int max_iterations, bool on_terminal = stdout_is_terminal());
  /// Ends the line of progress.
  ~Terminal() { end_progress(); }
  Terminal(Terminal&&) = delete;

  /// The planar baseline, which later lines compare with.
  void baseline(const SequenceNumbers& planar);
  /// A line of progress. `seconds`: of this iteration; the time left follows from those of the last ones.
  void iteration(const Iterate& iterate, double seconds);
  /// Ends a line of progress that would still be rewritten, so that other text can follow.
  void end_progress();
  /// All sequences of a run that was not interrupted (summary_table()), and how it ended.
  void table(const Summary& summary, const std::string& directory) const;

 private:
  std::string progress_text(const Iterate& iterate, double seconds) const;

  bool is_first_;
  int max_iterations_;
  bool on_terminal_;
  double planar_objective_ = 0.0;  ///< first objective term of the baseline
  double mean_seconds_ = 0.0;      ///< of an iteration
  bool line_open_ = false;         ///< a line that would be rewritten
};

}  // namespace fabseq
