// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/config/command_line.h"
#include "fabseq/config/setup.h"
#include "fabseq/tasks/starting_design.h"

#include <memory>
#include <optional>
#include <string>

namespace fabseq {

/// The same problem on elements of twice the edge lengths (docs/formulation.md 9, grid sequencing), which is
/// an optimization of its own with a directory of its own: `coarse` in that of the fine one. An element's
/// density is the mean over its fine elements, so that thin walls become grey and stay connected. Odd numbers
/// of elements are rounded up: the last coarse elements reach beyond the fine box, which is empty there. Node
/// sets that have no nodes on the coarse grid take the nearest ones; where samples are more than nodes, all
/// of them.
template <int Dim>
class CoarseGrid {
 public:
  /// `fine`: its config.optimizer.coarse_iterations are shared out, if there are any. Collective on its
  /// world; throws InputError, which names that key, where the part, its plate or its design leave no coarse
  /// problem.
  explicit CoarseGrid(const Setup<Dim>& fine);

  const Setup<Dim>& setup() const { return *setup_; }
  /// The design that the coarse run in `directory` came to, as one of the fine grid: each element has that
  /// of the coarse one it lies in. Writes it there, too, for -design. Collective on the world of both.
  FirstDesign refine(const Setup<Dim>& fine, const Design& design, const std::string& directory) const;

 private:
  std::unique_ptr<const Config> config_;
  std::unique_ptr<const Setup<Dim>> setup_;
};

/// The coarse grid that a run has to begin on; none if the config asks for none. Collective.
template <int Dim>
std::optional<CoarseGrid<Dim>> make_coarse_grid(const Setup<Dim>& fine, const CommandLine& command_line);

}  // namespace fabseq
