// SPDX-License-Identifier: MIT
/// \file
/// What the program says on the terminal of what it found out.
#pragma once

#include "fabseq/optimize/iterate.h"
#include "fabseq/run/progress.h"
#include "fabseq/run/summary.h"

#include <string>

namespace fabseq {

/// Value of every response, by the tasks that evaluate one design.
void print_responses(const SequenceNumbers& numbers);

/// Speaks on rank 0.
class Terminal {
 public:
  Terminal(MPI_Comm comm, int max_iterations) : progress_(comm), max_iterations_(max_iterations) {}

  /// The planar baseline, which later lines compare with.
  void baseline(const SequenceNumbers& planar);
  void iteration(const Iterate& iterate, double seconds);
  /// Ends the line of progress, so that other text can follow.
  void end_progress() { progress_.finish(); }
  /// All sequences of a run that was not interrupted, and how it ended.
  void table(const Summary& summary, const std::string& directory) const;

 private:
  Progress progress_;
  int max_iterations_;
  double planar_objective_ = 0.0;  ///< first objective term of the baseline
};

}  // namespace fabseq
