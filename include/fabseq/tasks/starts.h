// SPDX-License-Identifier: MIT
/// \file
/// Optimizations that begin with several designs, the best of which goes on (docs/formulation.md 9).
#pragma once

#include "fabseq/tasks/optimization.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// The designs of optimizer.starts. Each is optimized for a few iterations, in a run of its own with a
/// directory of its own: its number, from 1, in the folder `starts` of that of the whole run. A run that is
/// repeated with -restart goes on in each of these where it was, and comes to the same choice.
template <int Dim>
class Starts {
 public:
  /// `setup`: config.optimizer.starts is not empty; must outlive the object. Collective on its world; throws
  /// InputError, which names the entry that does not fit the part.
  explicit Starts(const Setup<Dim>& setup);

  std::size_t count() const { return designs_.size(); }
  /// The problem that all these runs solve.
  const Setup<Dim>& setup() const { return *short_; }
  /// The value of sequence.initial, as text.
  std::string name(std::size_t start) const { return to_text(whole_.config.optimizer.starts[start]); }
  /// Where one runs, of a run at `whole`. Collective.
  RunPlace place(const RunPlace& whole, std::size_t start) const;
  /// The design that one begins with, which is written into the directory of the whole run, too. Collective.
  FirstDesign design(std::size_t start, const std::string& directory) const;
  /// What the run of one in `directory` came to, for the run that goes on with it. Collective.
  FirstDesign result(const Design& design, const std::string& directory) const;

 private:
  const Setup<Dim>& whole_;
  std::vector<Design> designs_;  ///< of whole_
  std::unique_ptr<const Config> config_;
  std::unique_ptr<const Setup<Dim>> short_;
};

/// The starts that a run has to begin with; none if the config asks for none, or if there is a coarse grid,
/// whose run begins with them. Collective; throws InputError, also where the coarse run would.
template <int Dim>
std::optional<Starts<Dim>> make_starts(const Setup<Dim>& setup, const CommandLine& command_line,
                                       bool on_coarse_grid);

/// Optimizes each of the starts of a run at `place`, and returns the best design that they come to: the
/// feasible one of the smallest merit; if none is feasible, that with the smallest violation. Terms are
/// scaled as from sequence.initial in all of them, so that merits compare. One that fails is left out, with a
/// warning; the error of the last is thrown if all do. Collective.
template <int Dim>
FirstDesign begin_with_starts(const Starts<Dim>& starts, const CommandLine& command_line,
                              const RunPlace& place, RunOutput<Dim>& output, const Optimize<Dim>& optimize);

}  // namespace fabseq
